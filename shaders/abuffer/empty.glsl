// Module: `tracer` (PROVIDES_TRACER) or `hits` (PROVIDES_HITS) of an A-buffer without fragments: nothing is met.
#include "lib/tracer.glsl"

void M(aim)(inout Ray ray) {}

#ifdef PROVIDES_HITS
void M(all)(Ray ray) {}
#endif
#ifdef PROVIDES_TRACER
bool M(anyHit)(Ray ray) { return false; }
#endif
#if defined(REQUESTS_CLOSEST) || defined(REQUESTS_SURFACE)
bool M(closestHit)(Ray ray, out Hit hit) {
    hit = noHit;
    return false;
}
#endif
#ifdef REQUESTS_SURFACE
Surface M(surface)(Ray ray, Hit hit) { return facingSurface(ray, hit); }
#endif
