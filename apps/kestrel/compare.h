// The command `kestrel compare`: the error of an image file against a reference.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace kestrel {

struct CompareOptions {
    std::filesystem::path reference;
    std::filesystem::path test;
    std::filesystem::path heatMap; // empty: none. PNG: FLIP in magma; EXR, HDR: the errors themselves
    std::filesystem::path mask;    // empty: all pixels count. Pixels count where its luma is greater than 0.5
    // "METRIC=VALUE": mse, rmse, flip (the mean) and flip.mean, flip.weighted_median, flip.q1, flip.q3,
    // flip.min, flip.max may be at most, psnr and ssim must be at least VALUE.
    std::vector<std::string> limits;
    bool json = false;
};

// Measures `test` against `reference`, prints a table or one line of JSON (see toJson) on standard
// output, and returns the exit status: 0, or 1 if a limit is missed, after one line on standard
// error that names each. Two PNG files are compared as LDR, two HDR or EXR files as HDR. Throws
// InputError for a limit that is not of that form, a file that can't be read or written, one LDR
// and one HDR file, or images that can't be compared.
int compareCommand(const CompareOptions& options);

} // namespace kestrel
