// Every blended fragment adds its share, in any order (McGuire and Bavoil, "Weighted Blended Order-Independent Transparency",
// JCGT 2(2), 2013, equation 6): colour and alpha times a weight that falls with depth, and the logarithm of what it lets
// through, so that a product of all becomes a sum.
#include "transparency/fragment.glsl"
#include "lib/iterations.glsl"
#include "lib/view.glsl"
#ifdef RADIANCE
#include "lib/radiance.glsl"
#include <port:radiance>
#endif
#include "transparency/surface.glsl"

layout(std140) uniform DepthView { ViewData depthView; };

uniform float scale;

out vec4 out_weighted;
out float out_through;

// Equations 7 to 10; reversed depth is what equation 10 takes from 1.
float depthWeight(float z) {
    float near5 = z / 5.0;
    float near10 = z / 10.0;
    float far = z / 200.0;
#if EQUATION == 7
    return clamp(10.0 / (1e-5 + near5 * near5 + pow(far, 6.0)), 1e-2, 3e3);
#elif EQUATION == 8
    return clamp(10.0 / (1e-5 + near10 * near10 * near10 + pow(far, 6.0)), 1e-2, 3e3);
#elif EQUATION == 9
    return clamp(0.03 / (1e-5 + pow(far, 4.0)), 1e-2, 3e3);
#elif EQUATION == 10
    return max(1e-2, 3e3 * pow(gl_FragCoord.z, 3.0));
#else
    return 1.0;
#endif
}

void main() {
    if (!fragmentIsSeen()) discard;
    vec3 origin, direction;
    float tNear, tFar;
    cameraRay(depthView, gl_FragCoord.xy, origin, direction, tNear, tFar);
    vec3 colour;
    float alpha;
    if (!blendedSurface(fragmentTriangle(), origin, direction, colour, alpha)) discard;
    float weight = EQUATION > 0 ? alpha * depthWeight(v_depth * scale) : 1.0;
    // Of many surfaces float must hold the sum.
    out_weighted = vec4(min(colour, vec3(1e20)), 1.0) * (alpha * weight);
    out_through = log(max(1.0 - alpha, 1e-37));
}
