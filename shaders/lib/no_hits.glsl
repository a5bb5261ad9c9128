// Part of a module `tracer`: where there is nothing to be met.

bool M(anyHit)(Ray ray) { return false; }
bool M(closestHit)(Ray ray, out Hit hit) {
    hit = noHit;
    return false;
}
