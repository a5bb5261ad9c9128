// The module `layers` of a map of two resolutions. Cells are told from texels of the coarse map, which become -1 - texel.
#include "lib/frame.glsl"
#include "lib/layers.glsl"
#include "stochastic_depth/map.glsl"
#include <port:coarse>

layout(r32ui) uniform readonly uimage2D M(chosen);
layout(DEPTHS_FORMAT) uniform readonly image2DArray M(depths);
layout(std140) uniform M(DepthsView) { ViewData M(view); };

const int M(count) = LAYERS;

ivec2 M(texel)(vec2 uv) {
    ivec2 cell = mapTexelAt(M(view), uv * vec2(frame.size));
    uint traced = imageLoad(M(chosen), cell / depthCellsAcross).r;
    return (traced & depthCellBit(cell)) != 0u ? cell : -1 - M(coarse_texel)(uv);
}

vec2 M(position)(ivec2 texel) {
    vec2 fine = mapPlaceOf(M(view), texel, false) / vec2(frame.size);
    return texel.x < 0 ? M(coarse_position)(-1 - texel) : fine;
}

float M(depth)(ivec2 texel, int layer) {
    float coarse = M(coarse_depth)(max(-1 - texel, ivec2(0)), layer);
    vec4 four = imageLoad(M(depths), ivec3(max(texel, ivec2(0)), layer / 4));
    vec2 two = (layer & 2) != 0 ? four.zw : four.xy;
    return texel.x < 0 ? coarse : (layer & 1) != 0 ? two.y : two.x;
}
