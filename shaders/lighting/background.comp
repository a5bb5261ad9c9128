// The surroundings as the camera sees them where there is no surface.
#include "lib/environment_light.glsl"
#include "lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D depth;
layout(rgba16f) uniform writeonly image2D background;
layout(std140) uniform DepthView { ViewData depthView; };
layout(std140) uniform Settings { EnvironmentSettings environment; };
#ifdef PICTURE
uniform sampler2D picture;
#endif

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(background)))) return;
    vec3 origin, direction;
    float tNear, tFar;
    cameraRay(depthView, vec2(pixel) + 0.5, origin, direction, tNear, tFar);
#if defined(PICTURE)
    vec2 at = environmentCoordinate(direction, environment.rotation);
    vec3 light = environment.intensity * textureLod(picture, at, 0.0).rgb;
#elif defined(GRADIENT)
    vec3 light = gradientEnvironment(environment.zenith, environment.horizon, environment.ground, direction);
#else
    vec3 light = environment.horizon;
#endif
    bool nothing = texelFetch(depth, pixel, 0).r == 0.0;
    // The largest half float, never infinity.
    imageStore(background, pixel, vec4(nothing ? min(light, vec3(65504.0)) : vec3(0.0), 0.0));
}
