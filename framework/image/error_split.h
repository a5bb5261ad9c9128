// The mean squared error of a technique that traces a proxy of the scene, taken apart.
#pragma once
#include "image/image.h"
#include <array>

namespace kestrel {

// Two images of one thing with independent noise: two seeds, otherwise alike.
using ImageHalves = std::array<Image, 2>;

// Mean squares over all channels of the pixels that count. With the technique's error against an exact
// tracing of the same proxy called a, and the error of that tracing against the truth b, the expected (a +
// b)^2 is a^2 + b^2
// + 2ab; noise adds its variances. None of these can be read off one noisy image, since noise only adds to a
// square. Products of independent halves have no such part: mean a^2 is estimated by a of the one half times
// a of the other, and may come out a little below 0 where it is near it.
struct ErrorSplit {
    double mse = 0;            // of the technique against the reference: the mean of both halves
    double representation = 0; // b^2: what the map or field itself makes of the scene
    double algorithm = 0;      // a^2: snapping, steps, limits of iterations
    double cross = 0;          // 2ab: below 0 where the two make up for each other
    double sampling = 0;       // variance of the technique's own noise
    double referenceNoise = 0; // variance of the reference's
    // All parts together are `mse` but for the covariance of the technique's noise and the reference's, which
    // has the expectation 0 and tells how far the parts can be trusted.
    [[nodiscard]] double sum() const {
        return representation + algorithm + cross + sampling + referenceNoise;
    }
    friend bool operator==(const ErrorSplit&, const ErrorSplit&) = default;
};

// Half i of the technique and half i of the exact tracing may share their random numbers; nothing else may.
// Alpha is left out. `mask` may be null: every pixel counts, else those where it is greater than 0.5. Throws
// InputError as requireComparable() does.
ErrorSplit splitError(const ImageHalves& technique, const ImageHalves& exact, const ImageHalves& reference,
                      const Image* mask = nullptr);

} // namespace kestrel
