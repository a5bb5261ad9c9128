// The scene's records on the GPU (std430), filled by GpuScene.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// A material's reference to a texture: uv' = matrix * uv + offset, then wrapped, then a layer of an array.
struct TextureRecord {
    vec4 matrix;  // columns: (x, y), (z, w)
    vec2 offset;
    uint place;   // array in the low byte, layer above; noTexture: none
    uint flags;   // textureFlag…
    uvec2 source; // size of the image before it was resized to its array, texels
    uint side;    // of the image's square within its layer, texels
    uint corner;  // of the square: x in the low 16 bits, y above, texels
};

const uint noTexture = 0xffffffffu;
const uint textureFlagSecondTexCoord = 1u;
const uint textureFlagNearest = 2u;
const uint textureWrapShiftS = 2u; // two bits each: 0 repeat, 1 mirrored repeat, 2 clamp to edge
const uint textureWrapShiftT = 4u;

struct MaterialRecord {
    vec4 baseColour; // linear
    vec3 emission;   // linear radiance
    float metallic;
    float roughness;
    float normalScale;
    float alphaCutoff; // 0 for opaque materials
    uint flags;        // materialFlag…
    float transmission;
    float ior;
    uint pad0;
    uint pad1;
    TextureRecord baseColourTexture;
    TextureRecord metallicRoughnessTexture;
    TextureRecord normalTexture;
    TextureRecord emissionTexture;
};

const uint materialFlagMasked = 1u; // alpha mode Mask or Blend: tested against alphaCutoff
const uint materialFlagBlend = 2u;
const uint materialFlagDoubleSided = 4u;
const uint materialFlagUnlit = 8u;

// All of a vertex but its position.
struct VertexRecord {
    vec4 normal;   // w unused
    vec4 tangent;  // w: handedness; 0: none
    vec2 texCoord;
    vec2 texCoord1;
    vec4 colour;   // linear
};
const uint vertexRecordTexels = 4u; // as rgba32f texels, in this order

// What tells at a hit whether a masked triangle is there: three rgba32ui texels, one record a triangle from the first masked one on.
struct CutoutRecord {
    vec2 texCoord0, texCoord1, texCoord2; // of the corners, as the texture's own transform has them
    uint place;  // of the image's first word (low bits), cutoutNearest, cutoutBlend
    uint size;   // width - 1, height - 1 above, both wraps as in TextureRecord::flags topmost
    float alpha0, alpha1, alpha2; // of the corners, the material's factor included
    float threshold; // least alpha that is there
};
const uint cutoutTexels = 3u;
const uint cutoutPlaceMask = 0x3fffffffu;
const uint cutoutNearest = 0x40000000u; // read without a filter
const uint cutoutBlend = 0x80000000u;
const uint cutoutSizeMask = 0x3fffu;
const uint cutoutHeightShift = 14u;
const uint cutoutWrapShift = 28u; // two bits for each axis: 0 repeat, 1 mirrored repeat, 2 clamp to edge

// A light at the frame's time; render space.
struct LightRecord {
    vec3 position;
    uint kind;      // lightKind…
    vec3 direction; // of shining, unit
    float range;    // 0: infinite
    vec3 intensity; // candela, lux or radiance, by kind
    float cosInnerCone;
    vec3 tangent;   // of a rectangle
    float cosOuterCone;
    vec3 bitangent;
    uint pad0;
    vec2 halfSize;  // rectangle: half extents; sphere: radius in x
    vec2 pad1;
};

const uint lightKindPoint = 0u;
const uint lightKindSpot = 1u;
const uint lightKindDirectional = 2u;
const uint lightKindRectangle = 3u;
const uint lightKindSphere = 4u;

SHARED_END
