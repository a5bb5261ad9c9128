// The module interface `radiance`: the light at the end of a ray. A provider defines, wrapped in M():
//
//     vec3 M(surface)(Surface at, vec3 toward)   radiance that leaves the surface towards unit `toward`
//     vec3 M(miss)(vec3 direction)               radiance that arrives against unit `direction` where a ray meets nothing
//
// A module whose port says required::Surface reads normal and material of `at`; all others only position and error, so that
// they serve tracers that give positions only (facingSurface() of lib/tracer.glsl). Everything is in render space.
#include "lib/surface.glsl"
