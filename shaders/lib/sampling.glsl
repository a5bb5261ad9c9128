// Directions.

const float pi = 3.14159265358979;

// Orthonormal basis around unit n without a singularity (Duff et al., "Building an Orthonormal Basis, Revisited", 2017).
mat3 basisAround(vec3 n) {
    float s = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + n.z);
    float b = n.x * n.y * a;
    return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

// Unit square to unit disk, area preserving (Shirley and Chiu, "A Low Distortion Map Between Disk and Square", 1997).
vec2 concentricDisk(vec2 u) {
    vec2 p = 2.0 * u - 1.0;
    if (p.x == 0.0 && p.y == 0.0) return vec2(0.0);
    bool wide = abs(p.x) > abs(p.y);
    float major = wide ? p.x : p.y;
    float ratio = wide ? p.y / p.x : p.x / p.y;
    // Sine and cosine of pi / 4 times the ratio: polynomials that interpolate at Chebyshev points, within 6e-8. The angle is
    // known to lie within an octant's bounds, which general functions would find out for themselves.
    float s = ratio * ratio;
    float sine = ratio * (0.785398185 + s * (-0.0807454363 + s * (0.00249000685 - s * 3.59542901e-05)));
    float cosine = 1.0 + s * (-0.308424264 + s * (0.0158499107 - s * 0.000318877486));
    return major * (wide ? vec2(cosine, sine) : vec2(sine, cosine));
}

// Direction around unit n with density cosine / pi.
vec3 cosineHemisphere(vec2 u, vec3 n) {
    vec2 d = concentricDisk(u);
    return normalize(basisAround(n) * vec3(d, sqrt(max(0.0, 1.0 - dot(d, d)))));
}
