// How far two pictures are apart, and how far they may be.
#pragma once
#include "image/image.h"

namespace kestrel {

// Mean of the absolute differences over the mean of the first picture's absolute values, and the same with
// root mean squares: the first sees what is a little off everywhere, the second what is far off in few
// places.
struct StressDistance {
    double mean = 0, rms = 0;
    int x = -1, y = -1; // where they differ most
};
// Infinite where a value of either is no finite number, or sizes differ.
StressDistance stressDistance(const Image& a, const Image& b);

// `distance` over what is allowed: 1.25 times that of pictures of other seeds (a distance of independent
// noise scatters by some per cent from pair to pair), and no less than what one pixel in two hundred makes
// that is on the other side of an edge (rounding moves edges): 0.005 in the mean, its root in the root mean
// square. Above 1 it is too far.
double stressRatio(const StressDistance& distance, const StressDistance& seeds);

// The mean of what pixels hold, and how far it may be off: single samples of a light's surface are not
// bounded, their mean is.
struct StressMean {
    double sum = 0, squares = 0, count = 0;
    // The mean over R, G and B of each pixel.
    void add(const Image& image);
    [[nodiscard]] double mean() const { return count > 0 ? sum / count : 0; }
    [[nodiscard]] double error() const; // standard error of the mean
};

// Left and right exchanged.
Image mirrored(const Image& image);

} // namespace kestrel
