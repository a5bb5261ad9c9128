// Least and largest depth of the faces of boxes, as bounds.frag has them of triangles; of how many fragments a box tells nothing.
in float v_depth;
flat in float v_least;
flat in uint v_inside;
out vec4 OUTPUT;

void main() {
    OUTPUT = vec4(-(v_inside != 0u ? v_least : max(v_depth, v_least)), v_depth, 0.0, 0.0);
}
