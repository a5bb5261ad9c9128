// SHOW: 0 colour, 1-4 one channel as grey, 5 normal, 6 heat map of the first channel.
layout(local_size_x = 8, local_size_y = 8) in;

uniform SAMPLER source;
layout(rgba8) uniform writeonly image2D image;
uniform vec2 range; // shown as black and white
uniform int mip;
#ifdef LAYERED
uniform int layer;
#endif
#ifdef SOLID
uniform float slice;
#endif

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(image)))) return;
#if defined(LAYERED)
    vec4 value = vec4(texelFetch(source, ivec3(pixel, layer), mip));
#elif defined(SOLID)
    int depth = textureSize(source, mip).z;
    vec4 value = vec4(texelFetch(source, ivec3(pixel, min(int(slice * float(depth)), depth - 1)), mip));
#else
    vec4 value = vec4(texelFetch(source, pixel, mip));
#endif
#if CHANNELS == 1
    value = value.rrra;
#elif CHANNELS == 2
    value.b = 0.0;
#endif
#if SHOW == 5
    vec4 shown = 0.5 * value + 0.5;
#else
    vec4 shown = (value - range.x) / max(range.y - range.x, 1e-37);
#endif
    // NaN is shown as magenta: it must not pass for black.
    bool invalid = any(isnan(value));
#if SHOW == 1
    shown.rgb = shown.rrr;
#elif SHOW == 2
    shown.rgb = shown.ggg;
#elif SHOW == 3
    shown.rgb = shown.bbb;
#elif SHOW == 4
    shown.rgb = shown.aaa;
#elif SHOW == 6
    const vec3 table[17] = COLOUR_TABLE;
    float place = clamp(shown.r, 0.0, 1.0) * 16.0;
    int low = min(int(place), 15);
    shown.rgb = mix(table[low], table[low + 1], place - float(low));
#endif
    imageStore(image, pixel, invalid ? vec4(1.0, 0.0, 1.0, 1.0) : vec4(clamp(shown.rgb, 0.0, 1.0), 1.0));
}
