// One more sample of a running mean: m += (s - m) w / W. This form keeps a constant signal to the bit and loses no
// precision at high counts, where a sum would.
layout(local_size_x = 8, local_size_y = 8) in;

layout(SIGNAL_FORMAT) uniform readonly image2D signal;
layout(MEAN_FORMAT) uniform image2D result;
#ifdef WEIGHTED
layout(WEIGHT_FORMAT) uniform readonly image2D weight;
layout(r32f) uniform image2D total;
#endif
uniform float count; // samples in the mean, this one included; 1 starts anew
#ifdef WEIGHTED
uniform float keep; // factor on the old weights: below 1 once the mean forgets
#endif

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(result)))) return;
    vec4 sampled = imageLoad(signal, pixel);
#ifdef WEIGHTED
    float w = imageLoad(weight, pixel).r;
    float before = count > 1.0 ? imageLoad(total, pixel).r * keep : 0.0;
    float sum = before + w;
    float share = sum > 0.0 ? w / sum : 1.0;
    imageStore(total, pixel, vec4(sum));
#else
    float share = 1.0 / count;
#endif
    vec4 mean = count > 1.0 ? imageLoad(result, pixel) : sampled;
    imageStore(result, pixel, mean + (sampled - mean) * share);
}
