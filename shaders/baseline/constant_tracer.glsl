// The module `tracer` that looks at nothing: every ray meets something after DISTANCE, if that is defined.
#include "lib/tracer.glsl"

void M(aim)(inout Ray ray) {}

bool M(closestHit)(Ray ray, out Hit hit) {
    hit = noHit;
#ifdef DISTANCE
    hit.t = DISTANCE;
    return hit.t >= ray.tMin && hit.t <= ray.tMax;
#else
    return false;
#endif
}

bool M(anyHit)(Ray ray) {
    Hit hit;
    return M(closestHit)(ray, hit);
}
