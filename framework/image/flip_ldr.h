// LDR-FLIP of linear images: what both the LDR and the HDR metric come down to.
#pragma once
#include "image/flip_kernels.h"
#include "image/image.h"

namespace kestrel::detail {

// The error map (one channel, in [0, 1]) of two linear RGB images of one size with values in [0, 1].
Image flipOfLinear(const Image& reference, const Image& test, const FlipKernels& kernels);

} // namespace kestrel::detail
