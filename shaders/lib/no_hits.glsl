// Part of a module `tracer`: where there is nothing to be met.

bool M(anyHit)(Ray ray) { return false; }
#ifdef REQUESTS_MANY
uint M(anyHits)(uint wanted) { return 0u; }
#endif
#ifdef REQUESTS_MANY_CLOSEST
void M(closestHits)(uint wanted) {
    for (uint i = 0u; i < 32u; ++i)
        if ((wanted >> i & 1u) != 0u) M(give)(i, false, noHit);
}
#endif
bool M(closestHit)(Ray ray, out Hit hit) {
    hit = noHit;
    return false;
}
