// emission + layer diffuse albedo (direct shadow + area + (indirect + ambient) visibility) + specular + reflection; each term only
// where its input is connected. A part's define is the components to read of it: rgb, or rrr of one channel.
#ifdef LAYER_SIDE
#include "lib/view.glsl"
#endif

layout(local_size_x = 8, local_size_y = 8) in;

layout(ALBEDO_FORMAT) uniform readonly image2D albedo;
layout(rgba32f) uniform writeonly image2D result;
#ifdef DIRECT
uniform sampler2D direct;
#endif
#ifdef AREA
uniform sampler2D area;
#endif
#ifdef INDIRECT
uniform sampler2D indirect;
#endif
#ifdef VISIBILITY
uniform sampler2D visibility;
#endif
#ifdef SHADOWED
uniform sampler2D shadow;
#endif
#ifdef SPECULAR
uniform sampler2D specular;
#endif
#ifdef REFLECTION
uniform sampler2D reflection;
#endif
#ifdef EMISSION
uniform sampler2D emission;
#endif
#ifdef BACKGROUND
uniform sampler2D background;
#endif
#ifdef MATERIAL
uniform sampler2D material;
#endif
#ifdef AMBIENT
uniform vec3 ambient;
#endif
#ifdef LAYER_SIDE
uniform sampler2D depth;
uniform sampler2D normal;
uniform samplerBuffer layer; // rows of equal roughness, along them the cosine at the view
layout(std140) uniform DepthView { ViewData depthView; };

// Share of the diffuse light that the dielectric layer lets through towards the eye.
float throughLayer(ivec2 pixel, float roughness) {
    vec3 n = texelFetch(normal, pixel, 0).xyz;
    vec3 position = positionFromDepth(depthView, vec2(pixel) + 0.5, max(texelFetch(depth, pixel, 0).r, 1e-30));
    float size = dot(n, n);
    float cosine = size > 0.0 ? dot(n, towardsEye(depthView, position)) * inversesqrt(size) : 1.0;
    vec2 at = clamp(vec2(cosine, roughness), 0.0, 1.0) * float(LAYER_SIDE - 1);
    ivec2 low = min(ivec2(at), ivec2(LAYER_SIDE - 2));
    vec2 part = at - vec2(low);
    int first = low.y * LAYER_SIDE + low.x;
    float smoother = mix(texelFetch(layer, first).r, texelFetch(layer, first + 1).r, part.x);
    float rougher = mix(texelFetch(layer, first + LAYER_SIDE).r, texelFetch(layer, first + LAYER_SIDE + 1).r, part.x);
    return mix(smoother, rougher, part.y);
}
#endif

const float most = 1e30; // sums and products of parts stay finite

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(result)))) return;
    vec4 base = imageLoad(albedo, pixel);

    vec3 light = vec3(0.0);
#ifdef INDIRECT
    light += texelFetch(indirect, pixel, 0).INDIRECT;
#endif
#ifdef AMBIENT
    light += ambient;
#endif
#ifdef VISIBILITY
    light *= texelFetch(visibility, pixel, 0).VISIBILITY;
#endif
#ifdef DIRECT
    vec3 straight = texelFetch(direct, pixel, 0).DIRECT;
#ifdef SHADOWED
    straight *= texelFetch(shadow, pixel, 0).SHADOWED;
#endif
    light += straight;
#endif
#ifdef AREA
    light += texelFetch(area, pixel, 0).AREA;
#endif

    vec3 outgoing = base.rgb * light;
#ifdef MATERIAL
    vec3 surface = texelFetch(material, pixel, 0).MATERIAL;
    outgoing *= 1.0 - surface.y;
#ifdef LAYER_SIDE
    outgoing *= throughLayer(pixel, surface.x);
#endif
#endif
#ifdef SPECULAR
    outgoing += texelFetch(specular, pixel, 0).SPECULAR;
#endif
#ifdef REFLECTION
    outgoing += texelFetch(reflection, pixel, 0).REFLECTION;
#endif
#ifdef MATERIAL
    // glTF: an unlit surface shows its colour as it is.
    if (surface.z > 0.5) outgoing = base.rgb;
#endif
#ifdef EMISSION
    outgoing += texelFetch(emission, pixel, 0).EMISSION;
#endif
    bool nothing = base.a == 0.0;
    vec3 behind = vec3(0.0);
#ifdef BACKGROUND
    behind = texelFetch(background, pixel, 0).BACKGROUND;
#endif
    imageStore(result, pixel, vec4(min(nothing ? behind : outgoing, vec3(most)), nothing ? 0.0 : 1.0));
}
