// FLIP, the difference that a viewer sees when two images alternate.
//   LDR: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild, "FLIP: A Difference
//        Evaluator for Alternating Images" (HPG 2020).
//   HDR: Andersson, Nilsson, Shirley, Akenine-Moller, "Visualizing Errors in Rendered High Dynamic
//        Range Images" (Eurographics 2021, short papers).
#pragma once
#include "image/image.h"

namespace kestrel {

struct FlipOptions {
    // Viewing condition; 0.7 m before a monitor of 3840 pixels and 0.7 m width. In (0, 1000].
    float pixelsPerDegree = 67.0206433F;
    // LDR images hold sRGB code values in [0, 1] (others are clamped), HDR images linear light.
    bool hdr = false;
};

// What the error map is pooled to, over the pixels that count. The weighted percentiles weigh
// each pixel by its own error: the p-th is the least error such that the errors up to it sum to
// more than p times all errors.
struct FlipFigures {
    double mean = 0;
    double weightedMedian = 0;
    double q1 = 0;
    double q3 = 0;
    double min = 0;
    double max = 0;
};

// Exposures in stops at which HDR images are compared: `count` from `start` to `stop` evenly.
struct FlipExposures {
    double start = 0;
    double stop = 0;
    int count = 1;
};

struct FlipResult {
    Image map; // one channel, error in [0, 1]
    FlipFigures figures;
    FlipExposures exposures; // of an HDR comparison; 0, 0, 1 else
};

// FLIP of `test` against `reference`. One channel is taken for R = G = B, two for red and green, a fourth
// is left out. The map is made from whole images; `mask` (see requireComparable) only chooses the pixels that
// the figures count, as a filtered pixel sees its neighbours. Throws InputError as requireComparable does.
FlipResult flip(const Image& reference, const Image& test, const FlipOptions& options = {},
                const Image* mask = nullptr);

// The figures of an error map.
FlipFigures poolFlip(const Image& map, const Image* mask = nullptr);

// The exposures for a linear image: from where its greatest luminance to where its median luminance
// reaches 0.85 after the ACES tone map, about one a stop and at least two. Where half the pixels
// are black, the median of the others is taken; the published formula has no finite value there. A
// black image gets the exposure 0.
FlipExposures flipExposures(const Image& reference);

} // namespace kestrel
