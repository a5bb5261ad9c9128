// emission + diffuse albedo (direct shadow + area + (indirect + ambient) visibility) + specular + reflection; each term only
// where its input is connected. A part's define is the components to read of it: rgb, or rrr of one channel.
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
