// The filters of FLIP as separable kernels (Andersson et al. 2020, sections 4.1.1 and 4.2).
#pragma once
#include <algorithm>
#include <array>
#include <vector>

namespace kestrel::detail {

using Kernel = std::vector<float>;

// The contrast sensitivity functions, normalized in two dimensions: applied along the rows, then the columns.
struct SpatialKernels {
    Kernel luminance, redGreen;
    // The sensitivity to blue and yellow is a sum of two Gaussians, each a product of two passes.
    std::array<Kernel, 2> blueYellow;
    explicit SpatialKernels(float pixelsPerDegree);
};

// A Gaussian and its first and second derivative: detectors of edges and points (section 4.2). The positive
// weights of a derivative sum to 1, the negative ones to -1.
struct FeatureKernels {
    Kernel smooth, edge, point;
    explicit FeatureKernels(float pixelsPerDegree);
};

struct FlipKernels {
    SpatialKernels spatial;
    FeatureKernels feature;
    explicit FlipKernels(float pixelsPerDegree)
        : spatial(pixelsPerDegree)
        , feature(pixelsPerDegree) {}
    // How far a pixel's error depends on others, in pixels.
    [[nodiscard]] int radius() const {
        return static_cast<int>(std::max(spatial.luminance.size(), feature.smooth.size()) / 2);
    }
};

} // namespace kestrel::detail
