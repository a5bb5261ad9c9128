// Materials at a point: the same code for rasterized fragments and for hits of rays. Defines (materialDefines()):
//   MATERIAL_TEXTURES      some material has a texture; then also
//     MATERIAL_COLOUR_ARRAYS, MATERIAL_DATA_ARRAYS   how many arrays hold colour (sRGB) and data textures, 0 to 4
//     MATERIAL_TILED         some layers hold several textures
//   MATERIAL_MASKED        some material is alpha-tested
//     BLENDED_KEPT, BLENDED_ALONE, BLENDED_LEFT_OUT   blended ones otherwise (Blended of graph/types.h)
//   MATERIAL_NORMAL_MAPS   some material has a normal map
//   MATERIAL_COLOURS       some mesh has vertex colours
// Textures lie in few arrays by size, since there is no bindless texture on a CPU driver; a layer wraps by arithmetic.
#include "shared/scene.h"

layout(std430) readonly buffer Materials { MaterialRecord scene_materials[]; };

// Both texture coordinates and how they change from pixel to pixel. Zero changes read the finest level.
struct TexCoords {
    vec2 first, second;
    vec2 firstDx, firstDy, secondDx, secondDy;
};

// Of a hit: nothing is known of its footprint.
TexCoords texCoordsAtHit(vec2 first, vec2 second) {
    return TexCoords(first, second, vec2(0.0), vec2(0.0), vec2(0.0), vec2(0.0));
}

// What a material is at a point.
struct MaterialSample {
    vec4 baseColour; // linear, vertex colour included
    float metallic;
    float roughness;
    vec3 emission; // linear radiance
    bool unlit;
    float transmission;
    float ior;
};

#ifdef MATERIAL_TEXTURES

#if MATERIAL_COLOUR_ARRAYS > 0
uniform sampler2DArray scene_colour_textures[MATERIAL_COLOUR_ARRAYS];
#endif
#if MATERIAL_DATA_ARRAYS > 0
uniform sampler2DArray scene_data_textures[MATERIAL_DATA_ARRAYS];
#endif

// The sampler repeats. Mirroring folds; both mirroring and clamping keep half a texel from the border.
float wrapTexCoord(float x, uint mode, float side) {
    if (mode == 0u) return x;
    float folded = mode == 1u ? 1.0 - abs(x - 2.0 * floor(0.5 * x) - 1.0) : x;
    return clamp(folded, 0.5 / side, 1.0 - 0.5 / side);
}

// Coordinates within the array (xy, layer) and how they change.
void placeTexture(TextureRecord record, TexCoords coords, out vec3 at, out vec2 dx, out vec2 dy) {
    bool second = (record.flags & textureFlagSecondTexCoord) != 0u;
    mat2 turn = mat2(record.matrix.xy, record.matrix.zw);
    vec2 uv = turn * (second ? coords.second : coords.first) + record.offset;
    dx = turn * (second ? coords.secondDx : coords.firstDx);
    dy = turn * (second ? coords.secondDy : coords.firstDy);
    float side = float(record.side);
    if ((record.flags & textureFlagNearest) != 0u) {
        // To the middle of the image's texel, then of the array's texel there, where the filter has no effect.
        vec2 source = vec2(record.source);
        uv = (floor(uv * source) + 0.5) / source;
        uv = (floor(uv * side) + 0.5) / side;
    }
    at = vec3(wrapTexCoord(uv.x, (record.flags >> textureWrapShiftS) & 3u, side),
              wrapTexCoord(uv.y, (record.flags >> textureWrapShiftT) & 3u, side), float(record.place >> 8u));
}

#ifdef MATERIAL_TILED
// Four texels of one mip level of a square within a layer; beyond its border come those of the other side where it
// repeats, else the outermost once more. `size` is the square's side on that level.
vec4 tiledLevel(sampler2DArray map, TextureRecord record, vec3 at, int level) {
    int size = max(int(record.side) >> level, 1);
    ivec2 corner = ivec2(record.corner & 0xffffu, record.corner >> 16u) >> level;
    vec2 place = at.xy * float(size) - 0.5;
    ivec2 first = ivec2(floor(place));
    vec2 part = place - vec2(first);
    ivec2 second = first + 1;
    bvec2 repeats = equal(uvec2(record.flags >> textureWrapShiftS, record.flags >> textureWrapShiftT) & 3u, uvec2(0u));
    // Sides are powers of two: the bits above are the whole repetitions.
    first = mix(clamp(first, 0, size - 1), first & (size - 1), repeats);
    second = mix(clamp(second, 0, size - 1), second & (size - 1), repeats);
    int layer = int(at.z);
    vec4 above = mix(texelFetch(map, ivec3(corner + first, layer), level),
                     texelFetch(map, ivec3(corner + ivec2(second.x, first.y), layer), level), part.x);
    vec4 below = mix(texelFetch(map, ivec3(corner + ivec2(first.x, second.y), layer), level),
                     texelFetch(map, ivec3(corner + second, layer), level), part.x);
    return mix(above, below, part.y);
}

// As textureGrad of a texture that has the layer for itself: linear in both levels and between them.
vec4 tiledTexture(sampler2DArray map, TextureRecord record, vec3 at, vec2 dx, vec2 dy) {
    at.xy -= mix(vec2(0.0), floor(at.xy), equal(uvec2(record.flags >> textureWrapShiftS,
                                                      record.flags >> textureWrapShiftT) & 3u, uvec2(0u)));
    float side = float(record.side);
    float squared = side * side * max(dot(dx, dx), dot(dy, dy));
    float level = clamp(0.5 * log2(max(squared, 1.0)), 0.0, log2(side));
    vec4 fine = tiledLevel(map, record, at, int(level));
    return fract(level) == 0.0 ? fine : mix(fine, tiledLevel(map, record, at, int(level) + 1), fract(level));
}
#define readTexture(map) tiledTexture(map, record, at, dx, dy)
#else
#define readTexture(map) textureGrad(map, at, dx, dy)
#endif

// Sampler arrays take only dynamically uniform indices, so each array is asked by name. An absent texture is white.
vec4 colourTexture(TextureRecord record, TexCoords coords) {
#if MATERIAL_COLOUR_ARRAYS > 0
    vec3 at;
    vec2 dx, dy;
    placeTexture(record, coords, at, dx, dy);
    if (record.place == noTexture) return vec4(1.0);
    uint array = record.place & 255u;
#if MATERIAL_COLOUR_ARRAYS > 3
    if (array == 3u) return readTexture(scene_colour_textures[3]);
#endif
#if MATERIAL_COLOUR_ARRAYS > 2
    if (array == 2u) return readTexture(scene_colour_textures[2]);
#endif
#if MATERIAL_COLOUR_ARRAYS > 1
    if (array == 1u) return readTexture(scene_colour_textures[1]);
#endif
    return readTexture(scene_colour_textures[0]);
#else
    return vec4(1.0);
#endif
}

vec4 dataTexture(TextureRecord record, TexCoords coords) {
#if MATERIAL_DATA_ARRAYS > 0
    vec3 at;
    vec2 dx, dy;
    placeTexture(record, coords, at, dx, dy);
    if (record.place == noTexture) return vec4(1.0);
    uint array = record.place & 255u;
#if MATERIAL_DATA_ARRAYS > 3
    if (array == 3u) return readTexture(scene_data_textures[3]);
#endif
#if MATERIAL_DATA_ARRAYS > 2
    if (array == 2u) return readTexture(scene_data_textures[2]);
#endif
#if MATERIAL_DATA_ARRAYS > 1
    if (array == 1u) return readTexture(scene_data_textures[1]);
#endif
    return readTexture(scene_data_textures[0]);
#else
    return vec4(1.0);
#endif
}

#endif // MATERIAL_TEXTURES

// Whether something of that alpha is there, by its material's cutoff (0 of opaque ones) and whether it is blended.
bool alphaCovers(float alpha, float cutoff, bool blended) {
#if defined(BLENDED_LEFT_OUT)
    if (blended) return false;
#elif defined(BLENDED_ALONE)
    if (!blended) return false;
#endif
#if defined(BLENDED_KEPT) || defined(BLENDED_ALONE)
    if (blended) return alpha > 0.0;
#endif
    return alpha >= cutoff;
}

// Whether the surface is there at all: the alpha test of Mask and Blend materials. `vertexAlpha` is 1 without vertex
// colours. Reads the finest level always, so that a rasterized surface has the holes that rays see.
bool materialCovers(uint material, vec2 texCoord, vec2 texCoord1, float vertexAlpha) {
#ifdef MATERIAL_MASKED
    float alpha = scene_materials[material].baseColour.a;
#ifdef MATERIAL_COLOURS
    alpha *= vertexAlpha;
#endif
#ifdef MATERIAL_TEXTURES
    alpha *= colourTexture(scene_materials[material].baseColourTexture, texCoordsAtHit(texCoord, texCoord1)).a;
#endif
    bool blended = (scene_materials[material].flags & materialFlagBlend) != 0u;
    return alphaCovers(alpha, scene_materials[material].alphaCutoff, blended);
#else
    return true;
#endif
}

MaterialSample materialAt(uint material, TexCoords coords, vec4 vertexColour) {
    MaterialRecord record = scene_materials[material];
    MaterialSample point;
    point.baseColour = record.baseColour;
    point.metallic = record.metallic;
    point.roughness = record.roughness;
    point.emission = record.emission;
    point.unlit = (record.flags & materialFlagUnlit) != 0u;
    point.transmission = record.transmission;
    point.ior = record.ior;
#ifdef MATERIAL_COLOURS
    point.baseColour *= vertexColour;
#endif
#ifdef MATERIAL_TEXTURES
    point.baseColour *= colourTexture(record.baseColourTexture, coords);
    point.emission *= colourTexture(record.emissionTexture, coords).rgb;
    vec4 metallicRoughness = dataTexture(record.metallicRoughnessTexture, coords);
    point.roughness *= metallicRoughness.g;
    point.metallic *= metallicRoughness.b;
#endif
    return point;
}

// The shading normal, unit: `normal` and `tangent` interpolated (any length), bent by the normal map where there is one.
vec3 materialNormal(uint material, TexCoords coords, vec3 normal, vec4 tangent) {
    vec3 n = normalize(normal);
#ifdef MATERIAL_NORMAL_MAPS
    TextureRecord map = scene_materials[material].normalTexture;
    // A tangent along the normal spans no frame; interpolation may also leave none.
    vec3 t = tangent.xyz - n * dot(n, tangent.xyz);
    float lengthSquared = dot(t, t);
    vec3 bump = dataTexture(map, coords).xyz * 2.0 - 1.0;
    bump.xy *= scene_materials[material].normalScale;
    bool usable = map.place != noTexture && tangent.w != 0.0 && lengthSquared > 0.0;
    t *= inversesqrt(usable ? lengthSquared : 1.0);
    vec3 b = cross(n, t) * (tangent.w < 0.0 ? -1.0 : 1.0);
    vec3 bent = t * bump.x + b * bump.y + n * bump.z;
    if (usable && dot(bent, bent) > 0.0) n = normalize(bent);
#endif
    return n;
}
