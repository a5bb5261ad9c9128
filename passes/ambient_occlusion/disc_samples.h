// The samples that the kernels of ambient occlusion take on a disc around a point. Needs no GL.
#pragma once
#include <glm/glm.hpp>
#include <vector>

namespace kestrel {

enum class OcclusionKernelType { Vao, Hbao };

// `count` samples, a power of two up to shared::maxDiscSamples, at equal angles from +y on, their radii
// spread by the odd multiples of 1 / (2 count) in bit-reversed order: x, y on the unit disc, half the chord
// of the unit sphere there, one over the density that an estimate divides by. Of `Vao` that density is the
// chord, so that the mean estimates a volume (Loos and Sloan 2010, section 3); of `Hbao` samples crowd about
// the point (Tatarinov and Panteleev, "Advanced Ambient Occlusion Methods for Modern Games", 2016).
std::vector<glm::vec4> discSamples(OcclusionKernelType kernel, int count);

} // namespace kestrel
