#include "image/error_split.h"
#include "image/metrics.h"
#include <algorithm>

namespace kestrel {

ErrorSplit splitError(const ImageHalves& technique, const ImageHalves& exact, const ImageHalves& reference,
                      const Image* mask) {
    for (const ImageHalves* images : {&technique, &exact, &reference})
        for (const Image& image : *images) requireComparable(reference[0], image, mask);
    const bool grey = std::ranges::all_of(std::array{&technique, &exact, &reference}, [](const auto* images) {
        return (*images)[0].channels == 1 && (*images)[1].channels == 1;
    });
    const int channels = grey ? 1 : 3;
    std::array<ImageHalves, 3> all{technique, exact, reference};
    for (ImageHalves& images : all)
        for (Image& image : images) image = convertChannels(image, channels);
    ErrorSplit sums;
    size_t count = 0;
    for (size_t i = 0; i < all[2][0].values.size(); ++i) {
        if (mask != nullptr && !(mask->values[i / static_cast<size_t>(channels)] > 0.5F)) continue;
        const auto at = [&](size_t which, size_t half) { return double{all[which][half].values[i]}; };
        const double t1 = at(0, 0), t2 = at(0, 1), e1 = at(1, 0), e2 = at(1, 1), r1 = at(2, 0), r2 = at(2, 1);
        sums.mse += ((t1 - r1) * (t1 - r1) + (t2 - r2) * (t2 - r2)) / 2;
        sums.representation += (e1 - r1) * (e2 - r2);
        sums.algorithm += (t1 - e1) * (t2 - e2);
        sums.cross += (t1 - e1) * (e2 - r2) + (t2 - e2) * (e1 - r1);
        sums.sampling += (t1 - t2) * (t1 - t2) / 2;
        sums.referenceNoise += (r1 - r2) * (r1 - r2) / 2;
        ++count;
    }
    for (double* sum : {&sums.mse, &sums.representation, &sums.algorithm, &sums.cross, &sums.sampling,
                        &sums.referenceNoise})
        *sum /= static_cast<double>(std::max<size_t>(count, 1));
    return sums;
}

} // namespace kestrel
