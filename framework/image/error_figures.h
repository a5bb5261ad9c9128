// All errors of one image against its reference at once.
#pragma once
#include "image/flip.h"
#include "image/image.h"
#include <string>

namespace kestrel {

struct ErrorFigures {
    double mse = 0;
    double rmse = 0;
    double psnr = 0; // dB; infinity for equal images
    double ssim = 0;
    FlipFigures flip;
};

struct ErrorOptions {
    // LDR: sRGB code values in [0, 1], peak and dynamic range 1, LDR-FLIP. HDR: linear light, peak and
    // dynamic range the greatest value of the reference (1 for a black one), HDR-FLIP.
    bool hdr = false;
    float pixelsPerDegree = FlipOptions{}.pixelsPerDegree;
    const Image* mask = nullptr; // pixels count where it is greater than 0.5; null: all
    // Left out where nobody asks for them, since they take most of the time: they stay 0.
    bool ssim = true, flip = true;
};

// The errors of `test` against `reference`. Alpha is left out; where the channels differ, both are taken as
// RGB. If `flipMap` is not null it receives the FLIP error map. Throws InputError as requireComparable does.
ErrorFigures measureError(const Image& reference, const Image& test, const ErrorOptions& options = {},
                          Image* flipMap = nullptr);

// {"mse","rmse","psnr","ssim","flip":{"mean","weighted_median","q1","q3","min","max"}} in this order, in one
// line; an infinite PSNR is null.
std::string toJson(const ErrorFigures& figures);

} // namespace kestrel
