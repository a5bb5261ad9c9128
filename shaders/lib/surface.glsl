// What is known of a hit once it has been evaluated.
struct Surface {
    vec3 position;
    float error;        // how far from there the surface may lie (Hit::error); where it is not 0, normal and material are unknown
    vec3 normal;        // geometric, unit, towards the side the ray came from
    vec3 shadingNormal; // interpolated or from a normal map; on the same side
    vec3 albedo;        // linear base colour
    float metallic;
    float roughness;
    vec3 emission;      // linear radiance
    uint material;
    bool front;         // the ray met the front side
    float reach;        // faceReach() of shared/ray.h
};
