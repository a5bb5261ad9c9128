// The module interface `hits`: every hit along a ray, in any order. A provider defines, wrapped in M():
//
//     void M(all)(Ray ray)
//
// which hands each hit to the consumer's
//
//     bool M(visit)(inout Ray ray, Hit hit)   true stops; the consumer may shorten ray.tMax
//
// that the consumer defines under its port's name (`hits_visit`) before it includes the module.
#include "lib/tracer.glsl"
