// Which pixels of a view a triangle touches, and between which depths in each: never too few and never too little,
// whatever rounding does (the conservative rasterization of "DIRT: Deferred Image-based Ray Tracing", Vardis,
// Vasilakis, Papaioannou, HPG 2016, without the hardware for it).
//
// Everything is in clip space's x, y and w, where what a pixel sees is the cone of the directions (x, y, 1) of its
// square, and what a triangle covers the cone of its corners. Two cones are apart if a side of one of them parts them:
// so corners behind the eye need no clipping (Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous
// Coordinates", 1997).
#include "abuffer/march.glsl"

// Of a pixel's half width beyond its own half: what the rounding of a ray's place in the view may be.
const float coverMargin = 0.03125;
// Bounds the rounding of a product of three lengths, and of their sums.
const float coverDoubt = 2e-6;

struct CoveredTriangle {
    // At least -slack over all directions that it covers.
    vec3 edges[3];
    vec3 slack;
    // Depth is `plane` over the dot product with the normal, where neither is in doubt; else it lies between the
    // corners'.
    vec3 normal;
    float plane;
    float normalDoubt;
    float planeDoubt;
    vec2 depths;
    // Of pixels, both inclusive; none if `last` lies before `first`.
    ivec2 first;
    ivec2 last;
};

float smaller(vec3 v) { return min(v.x, min(v.y, v.z)); }
float larger(vec3 v) { return max(v.x, max(v.y, v.z)); }

// b x c by the corner that is nearer to the eye and the edge: in large numbers nothing is subtracted.
vec3 edgeBetween(vec3 b, vec3 c, out float doubt) {
    vec3 edge = c - b;
    bool byB = dot(b, b) < dot(c, c);
    vec3 nearer = byB ? b : c;
    doubt = coverDoubt * length(nearer) * length(edge);
    return cross(nearer, edge);
}

// Adds to the box [low, high] in [-1, 1] what lies at `p`, and where the edge to `q` meets the depth `near`.
void addCorner(vec3 p, vec3 q, float near, inout vec2 low, inout vec2 high) {
    if (p.z >= near) {
        low = min(low, p.xy / p.z);
        high = max(high, p.xy / p.z);
    }
    if ((p.z < near) != (q.z < near)) {
        vec3 a = p.z < near ? q : p; // the same either way round
        vec3 b = p.z < near ? p : q;
        vec2 at = mix(a.xy, b.xy, clamp((a.z - near) / (a.z - b.z), 0.0, 1.0)) / near;
        float doubt = coverDoubt * (length(a) + length(b)) / near;
        low = min(low, at - doubt);
        high = max(high, at + doubt);
    }
}

CoveredTriangle coveredTriangle(ViewData frame, ABufferShape shape, uint view, vec3 p0, vec3 p1, vec3 p2) {
    vec3 eye = frame.position.xyz;
    vec4 s0 = abufferSeen(frame, shape.nearPlane, view, p0 - eye, 1.0);
    vec4 s1 = abufferSeen(frame, shape.nearPlane, view, p1 - eye, 1.0);
    vec4 s2 = abufferSeen(frame, shape.nearPlane, view, p2 - eye, 1.0);
    vec3 a = s0.xyz;
    vec3 b = s1.xyz;
    vec3 c = s2.xyz;
    CoveredTriangle made;
    vec3 depths = vec3(s0.w, s1.w, s2.w);
    made.depths = vec2(smaller(depths), larger(depths));

    // Nothing that a ray could meet lies nearer than the near plane; of a parallel view w is 1 everywhere.
    bool parallel = view == 0u && frame.position.w != 0.0;
    float near = 0.999 * abufferNear(frame, shape, view);
    vec2 low = vec2(1e30);
    vec2 high = vec2(-1e30);
    if (made.depths.y >= near) {
        float cut = parallel ? 0.5 : near;
        addCorner(a, b, cut, low, high);
        addCorner(b, c, cut, low, high);
        addCorner(c, a, cut, low, high);
    }
    vec2 size = vec2(abufferSize(frame, shape, view));
    made.first = max(ivec2(floor(clamp((low * 0.5 + 0.5) * size - coverMargin, -1.0, size.x + size.y))), ivec2(0));
    made.last = min(ivec2(floor(clamp((high * 0.5 + 0.5) * size + coverMargin, -1.0, size.x + size.y))), ivec2(size) - 1);

    made.edges[0] = edgeBetween(a, b, made.slack.x);
    made.edges[1] = edgeBetween(b, c, made.slack.y);
    made.edges[2] = edgeBetween(c, a, made.slack.z);
    vec3 ab = b - a;
    vec3 ac = c - a;
    float lengths = length(ab) * length(ac);
    // By the nearest corner too.
    vec3 distances = vec3(dot(a, a), dot(b, b), dot(c, c));
    vec3 nearest = distances.x <= min(distances.y, distances.z) ? a : (distances.y <= distances.z ? b : c);
    made.normal = cross(ab, ac);
    made.plane = dot(nearest, made.normal);
    made.normalDoubt = coverDoubt * lengths;
    made.planeDoubt = coverDoubt * lengths * length(nearest);
    if (abs(made.plane) <= made.planeDoubt) {
        // Seen along its plane: which side is within is in doubt, and the box alone says what it covers.
        made.slack = vec3(3.0e38);
    }
    float side = made.plane < 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < 3; ++i) made.edges[i] *= side;
    made.normal *= side;
    made.plane *= side;
    if (parallel) made.normal = vec3(0.0); // the depths of its corners have to do
    return made;
}

// Does it touch the square of `width` pixels whose lower left pixel is this one? If so between which depths.
bool covers(CoveredTriangle triangle, vec2 size, ivec2 pixel, float width, out vec2 depths) {
    vec3 centre = vec3((vec2(pixel) + 0.5 * width) * 2.0 / size - 1.0, 1.0);
    vec2 reach = (width + 2.0 * coverMargin) / size;
    bool apart = false;
    apart = apart || dot(triangle.edges[0], centre) + dot(abs(triangle.edges[0].xy), reach) < -triangle.slack.x;
    apart = apart || dot(triangle.edges[1], centre) + dot(abs(triangle.edges[1].xy), reach) < -triangle.slack.y;
    apart = apart || dot(triangle.edges[2], centre) + dot(abs(triangle.edges[2].xy), reach) < -triangle.slack.z;
    float steep = dot(triangle.normal, centre);
    float change = dot(abs(triangle.normal.xy), reach) + 2.0 * triangle.normalDoubt;
    depths = triangle.depths;
    if (steep + change > 0.0) depths.x = max(depths.x, (triangle.plane - triangle.planeDoubt) / (steep + change));
    if (steep - change > 0.0) depths.y = min(depths.y, (triangle.plane + triangle.planeDoubt) / (steep - change));
    depths = vec2(max(depths.x, 0.0) * 0.99999, max(depths.y, 0.0) * 1.00001);
    return !apart && depths.x <= depths.y;
}
