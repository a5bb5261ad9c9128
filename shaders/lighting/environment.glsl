// The module `radiance` by the surroundings: what a ray that meets nothing sees.
#include "lib/environment_light.glsl"
#include "lib/radiance.glsl"

layout(std140) uniform M(Settings) { EnvironmentSettings M(environment); };
#ifdef PICTURE
uniform sampler2D M(picture);
#endif

vec3 M(surface)(Surface at, vec3 toward) { return vec3(0.0); }

vec3 M(miss)(vec3 direction) {
#if defined(PICTURE)
    vec2 at = environmentCoordinate(direction, M(environment).rotation);
    return M(environment).intensity * textureLod(M(picture), at, 0.0).rgb;
#elif defined(GRADIENT)
    return gradientEnvironment(M(environment).zenith, M(environment).horizon, M(environment).ground, direction);
#else
    return M(environment).horizon;
#endif
}
