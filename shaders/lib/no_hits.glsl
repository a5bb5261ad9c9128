// Part of a module `tracer`: where there is nothing to be met.

bool M(anyHit)(Ray ray) { return false; }
#ifdef REQUESTS_MANY
uint M(anyHits)(uint wanted) { return 0u; }
#endif
bool M(closestHit)(Ray ray, out Hit hit) {
    hit = noHit;
    return false;
}
