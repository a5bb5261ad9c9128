// The command `kestrel compare`: the errors of image files against a reference.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace kestrel {

// Pictures are files, or layers of EXR files as in "file.exr:beauty" (see imageName).
struct CompareOptions {
    std::filesystem::path reference;
    std::vector<std::filesystem::path> tests; // at least one
    // Empty: none. PNG: FLIP in magma; EXR, HDR: the errors themselves. "{}" stands for the test's name
    // without folder and ending, and must be there where there are several tests.
    std::string heatMap;
    std::filesystem::path mask; // empty: all pixels count. Pixels count where its luma is greater than 0.5
    // "METRIC=VALUE": mse, rmse, flip (the mean) and flip.mean, flip.weighted_median, flip.q1, flip.q3,
    // flip.min, flip.max may be at most, psnr and ssim must be at least VALUE; for every test.
    std::vector<std::string> limits;
    bool json = false;
};

// Measures each test against `reference` and prints a table on standard output: of all figures for one test,
// with a row a test for several. With `json` it is one line: an object (see toJson), or for several tests an
// array of such objects that begin with the test's name. Returns the exit status: 0, or 1 if a limit is
// missed, after one line a test on standard error that names each. PNG files are compared as LDR, HDR or EXR
// files as HDR. Throws InputError for a limit that is not of that form, a file that can't be read or written,
// LDR beside HDR files, or images that can't be compared: with all that is wrong, after the figures of those
// of several tests that could be measured.
int compareCommand(const CompareOptions& options);

} // namespace kestrel
