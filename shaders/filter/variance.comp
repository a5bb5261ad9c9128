// The variance that guides the spatial filter (SVGF, section 4.2): of the history where it is long enough to tell, else of the
// 7 x 7 pixels around on the same surface.
#include "filter/signal.glsl"
#include "filter/records.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(HISTORY_FORMAT) uniform readonly image2D MEAN;
RECORDS(vec4, rgba32f, moments, Moments);
RECORDS(vec4, rgba32f, geometry, Geometry);
layout(std140) uniform ResultView { ViewData resultView; };
#ifdef TARGET
WRITES_RECORDS(FILTERED_TYPE, filtered, TARGET); // what the first iteration reads
#endif
#ifdef VARIANCE
layout(r32f) uniform writeonly image2D variance;
#endif
uniform float sigmaDepth;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(MEAN);
    if (any(greaterThanEqual(pixel, size))) return;
    ivec2 last = size - 1;

    vec4 centre = imageLoad(MEAN, pixel);
    int record = recordIndex(pixel, size);
    vec4 moment = RECORD(moments, record);
    vec4 surface = RECORD(geometry, record);
    float light = brightness(centre);
    ImagePlane plane = imagePlane(resultView, mat3(resultView.view) * surface.xyz, vec2(pixel) + 0.5, surface.w,
                                  pictureScale(resultView, surface.w) * sigmaDepth);
    // The loop ends at once where nothing is to be estimated: leaving a loop is all that saves work on a CPU driver.
    bool isShort = surface.w > 0.0 && moment.z < 4.0;
    float weights = 1.0, sum = 0.0, squares = 0.0;
    int end = isShort ? 49 : 1;
    for (int i = 0; i < end; ++i) {
        ivec2 at = pixel + ivec2(i % 7, i / 7) - 3;
        ivec2 inside = clamp(at, ivec2(0), last);
        vec4 other = RECORD(geometry, recordIndex(inside, size));
        bool counts = at == inside && other.w > 0.0 && at != pixel && dot(other.xyz, surface.xyz) > 0.9 &&
                      abs(planeDistance(plane, vec2(at) + 0.5, other.w)) < 1.0;
        float d = counts ? brightness(imageLoad(MEAN, inside)) - light : 0.0;
        weights += counts ? 1.0 : 0.0;
        sum += d;
        squares += d * d;
    }
    float mean = sum / weights;
    float around = max(squares / weights - mean * mean, 0.0) * 4.0 / max(moment.z, 1.0);
    // Over frames the spread of the samples, of n in the mean; n / (n - 1) since the mean is of the same samples.
#ifdef OF_SAMPLES
    // The paper's. A filtered history goes through the filter again and again, and a stop as narrow as the mean's own
    // deviation would pull it towards what most pixels show.
    around *= max(moment.z, 1.0);
    float over = moment.y * moment.z / (moment.z - 1.0);
#else
    float over = moment.y / (moment.z - 1.0);
#endif
    float estimate = surface.w == 0.0 ? 0.0 : isShort ? around : over;
#ifdef TARGET
#ifdef ONE_CHANNEL
    filtered[record] = vec2(centre.r, estimate);
#else
    filtered[record] = vec4(centre.rgb, estimate);
#endif
#endif
#ifdef VARIANCE
    imageStore(variance, pixel, vec4(estimate));
#endif
}
