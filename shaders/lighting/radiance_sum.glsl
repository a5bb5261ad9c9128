// The module `radiance` as a sum of others.
#include "lib/radiance.glsl"
#ifdef FIRST
#include <port:first>
#endif
#ifdef SECOND
#include <port:second>
#endif
#ifdef THIRD
#include <port:third>
#endif
#ifdef FOURTH
#include <port:fourth>
#endif

vec3 M(surface)(Surface at, vec3 toward) {
    vec3 sum = vec3(0.0);
#ifdef FIRST
    sum += M(first_surface)(at, toward);
#endif
#ifdef SECOND
    sum += M(second_surface)(at, toward);
#endif
#ifdef THIRD
    sum += M(third_surface)(at, toward);
#endif
#ifdef FOURTH
    sum += M(fourth_surface)(at, toward);
#endif
    return sum;
}

vec3 M(miss)(vec3 direction) {
    vec3 sum = vec3(0.0);
#ifdef FIRST
    sum += M(first_miss)(direction);
#endif
#ifdef SECOND
    sum += M(second_miss)(direction);
#endif
#ifdef THIRD
    sum += M(third_miss)(direction);
#endif
#ifdef FOURTH
    sum += M(fourth_miss)(direction);
#endif
    return sum;
}
