// Begins a path at the surface of each pixel, or of each pixel of a list: what the lights give there, what it sends out of
// itself, and the first ray. Slots are numbered in tiles of 8 x 8 pixels, so that neighbours in the buffers are neighbours in
// the picture.
#include "lib/face.glsl"
#include "lib/iterations.glsl"
#include "lib/radiance.glsl"
#include <port:radiance>
#include "ray_effects/path.glsl"

#ifdef LISTED
layout(local_size_x = 64) in;
layout(std430) readonly buffer Pixels {
    WorkListHeader header;
    uint items[];
} list;
#else
layout(local_size_x = 8, local_size_y = 8) in;
#endif

uniform sampler2D depth;
uniform sampler2D normal;
uniform sampler2D albedo;
uniform sampler2D material;
#ifdef EMISSION
uniform sampler2D emission;
#endif
#ifdef REFRACTION
uniform sampler2D refraction;
#endif
layout(std140) uniform DepthView { ViewData depthView; };

void main() {
#ifdef LISTED
    uint slot = gl_GlobalInvocationID.x;
    bool exists = slot < list.header.count;
    ivec2 pixel = unpackPixel(list.items[exists ? slot : 0u]);
#else
    uint slot = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    bool exists = all(lessThan(pixel, textureSize(depth, 0)));
#endif
    float z = texelFetch(depth, pixel, 0).r;
    vec4 n = texelFetch(normal, pixel, 0);
    bool background = z == 0.0 || dot(n.xyz, n.xyz) == 0.0 || !exists;
    vec3 smoothNormal = background ? vec3(0.0, 0.0, 1.0) : normalize(n.xyz);
    vec3 position = positionFromDepth(depthView, vec2(pixel) + 0.5, background ? 1.0 : z);
    vec3 toward = towardsEye(depthView, position);
    vec4 face = faceAt(pixel, smoothNormal, depthView, position, n.w);
    vec3 surface = texelFetch(material, pixel, 0).xyz;
    BsdfSurface bsdf = BsdfSurface(texelFetch(albedo, pixel, 0).rgb, surface.y, surface.x, 0.0, 1.5);
#ifdef REFRACTION
    bsdf.transmission = texelFetch(refraction, pixel, 0).x;
    bsdf.eta = background ? 1.0 : texelFetch(refraction, pixel, 0).y;
#endif
    Surface at = Surface(position, 0.0, face.xyz, smoothNormal, bsdf.colour, bsdf.metallic, bsdf.roughness, vec3(0.0), 0u, true,
                         0.0);
    bool unlit = surface.z > 0.5; // glTF: it shows its colour as it is
    bool goes = !background && !unlit;
    vec3 direct = scatter(at, bsdf, toward, face.w, vec3(1.0), slot, pixel, 0u, goes);
#ifdef EMISSION
    vec3 own = texelFetch(emission, pixel, 0).rgb;
#else
    vec3 own = vec3(0.0);
#endif
    direct = own + (unlit ? bsdf.colour : direct);
    if (background) direct = radiance_miss(-toward);
    if (exists) {
        light[2u * slot] = vec4(direct, 1.0);
        light[2u * slot + 1u] = vec4(0.0);
    }
#ifndef LAST
    goOn(slot, goes, 0u);
#endif
    ITERATIONS_END;
}
