// Temporal anti-aliasing. The samples of a pixel over the frames' jitter fill the pixel, so their mean is the picture
// under a box filter; the history carries it along. After Karis, "High-Quality Temporal Supersampling" (2014): motion of
// the nearest surface around, so that edges move with what is in front; a Catmull-Rom filter where the history lies
// between pixels; clipping in YCoCg. The box is Salvi's ("An Excursion in Temporal Supersampling", 2016): the mean and
// the deviation of the 3 x 3 pixels around.
//
// A tight box stops ghosts, but cuts off what only some of the jittered samples see. So it is tight only until a pixel
// has neither moved nor changed its depth for some frames.
layout(local_size_x = 8, local_size_y = 8) in;

layout(COLOUR_FORMAT) uniform readonly image2D colour;
layout(RESULT_FORMAT) uniform readonly image2D previous_result;
layout(RESULT_FORMAT) uniform writeonly image2D result;
// Reversed depth, frames at rest, frames in the mean.
layout(rgba32f) uniform readonly image2D previous_past;
layout(rgba32f) uniform writeonly image2D past;
uniform sampler2D depth;
#ifdef MOTION
uniform sampler2D motion;
#endif
uniform int restart;
uniform float feedback;
uniform float gamma;
uniform float gammaStill;

const float settled = 8.0; // frames at rest until the box is wide

#ifdef TAME
vec3 tamed(vec3 c) { return c / (1.0 + max(dot(c, vec3(0.25, 0.5, 0.25)), 0.0)); }
vec3 untamed(vec3 c) { return c / max(1.0 - dot(c, vec3(0.25, 0.5, 0.25)), 1e-4); }
#else
vec3 tamed(vec3 c) { return c; }
vec3 untamed(vec3 c) { return c; }
#endif

vec3 toYCoCg(vec3 c) {
    return vec3(dot(c, vec3(0.25, 0.5, 0.25)), 0.5 * (c.r - c.b), dot(c, vec3(-0.25, 0.5, -0.25)));
}
vec3 fromYCoCg(vec3 c) { return vec3(c.x + c.y - c.z, c.x + c.z, c.x - c.y - c.z); }

// Weights of the four texels from one before to two after, at `f` between the middle two.
vec4 catmullRom(float f) {
    float f2 = f * f, f3 = f2 * f;
    return vec4(-0.5 * f3 + f2 - 0.5 * f, 1.5 * f3 - 2.5 * f2 + 1.0, -1.5 * f3 + 2.0 * f2 + 0.5 * f, 0.5 * f3 - 0.5 * f2);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(result);
    if (any(greaterThanEqual(pixel, size))) return;
    ivec2 last = size - 1;

    vec4 sampled = imageLoad(colour, pixel);
    vec3 now = tamed(sampled.rgb);
    float z = texelFetch(depth, pixel, 0).r;
    ivec2 nearest = pixel;
    float nearDepth = z, farDepth = z;
    vec3 sum = vec3(0.0), squares = vec3(0.0);
    vec3 least = vec3(0.0), most = vec3(0.0); // of all that the result is made of, over `now`
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            ivec2 at = clamp(pixel + ivec2(x, y), ivec2(0), last);
            float d = texelFetch(depth, at, 0).r;
            if (d > nearDepth) nearest = at;
            nearDepth = max(nearDepth, d);
            farDepth = min(farDepth, d);
            // As differences to this pixel: a constant stays itself to the bit.
            vec3 beside = tamed(imageLoad(colour, at).rgb) - now;
            least = min(least, beside);
            most = max(most, beside);
            vec3 c = toYCoCg(beside);
            sum += c;
            squares += c * c;
        }
    vec3 mean = sum / 9.0;
    vec3 deviation = sqrt(max(squares / 9.0 - mean * mean, vec3(0.0)));

    vec2 shift = vec2(0.0);
#ifdef MOTION
    shift = texelFetch(motion, nearest, 0).xy;
#endif
    vec2 texel = vec2(pixel) + shift;
    bool seen = restart == 0 && all(greaterThanEqual(texel, vec2(-0.5))) && all(lessThan(texel, vec2(size) - 0.5));
    texel = clamp(texel, vec2(0.0), vec2(last));
    ivec2 closest = ivec2(texel + 0.5);
    vec4 before = imageLoad(previous_past, closest);

#ifdef MOTION
    // Without the corners of 4 x 4: what five bilinear fetches would read.
    ivec2 corner = ivec2(floor(texel));
    vec4 wx = catmullRom(texel.x - float(corner.x)), wy = catmullRom(texel.y - float(corner.y));
    vec3 history = vec3(0.0);
    float weights = 0.0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            float w = (i == 0 || i == 3) && (j == 0 || j == 3) ? 0.0 : wx[j] * wy[i];
            ivec2 at = clamp(corner + ivec2(j - 1, i - 1), ivec2(0), last);
            vec3 there = tamed(imageLoad(previous_result, at).rgb) - now;
            history += w * there;
            weights += w;
            least = min(least, there);
            most = max(most, there);
        }
    history /= weights;
#else
    vec3 history = tamed(imageLoad(previous_result, closest).rgb) - now;
    least = min(least, history);
    most = max(most, history);
#endif

    bool atRest = dot(shift, shift) < 1e-4 && before.x >= farDepth * 0.98 && before.x <= nearDepth * 1.02;
    float rest = seen && atRest ? min(before.y + 1.0, settled) : 0.0;
    float frames = seen ? before.z : 0.0;

    // Towards the mean until inside the box.
    vec3 box = deviation * mix(gamma, gammaStill, rest / settled);
    vec3 off = toYCoCg(history) - mean;
    vec3 outside = mix(abs(off) / max(box, 1e-30), vec3(0.0), equal(off, vec3(0.0)));
    float over = max(max(outside.x, outside.y), max(outside.z, 1.0));
    history = fromYCoCg(mean + off / over);

    float fresh = max(1.0 - feedback, 1.0 / (frames + 1.0));
    // Neither the filter's negative lobes nor rounding lead out of the range of what was averaged.
    history = clamp((1.0 - fresh) * history, least, most);
    vec3 made = seen ? untamed(now + history) : sampled.rgb;
    imageStore(result, pixel, vec4(made, sampled.a));
    imageStore(past, pixel, vec4(z, rest, min(frames + 1.0, 1e6), 0.0));
}
