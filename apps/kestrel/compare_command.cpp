// `kestrel compare` on the command line; what it does is in compare.cpp.
#include "commands.h"
#include "compare.h"
#include <memory>

namespace kestrel {

void addCompareCommand(CLI::App& app, Run& run) {
    CLI::App* command = app.add_subcommand("compare", "Measure images against a reference");
    const auto options = std::make_shared<CompareOptions>();
    command->add_option("REFERENCE", options->reference, "Image file (PNG, HDR, EXR), or FILE.exr:LAYER")
        ->required();
    command->add_option("TEST", options->tests, "Image files of the same size and kind")->required();
    command->add_option(
        "--heatmap", options->heatMap,
        "Write the FLIP error: .png in colours, .hdr or .exr as values; {} in the name stands for "
        "the test's name, and must be there for several tests");
    command->add_option("--mask", options->mask, "Image file: only pixels with a luma above 0.5 count");
    command
        ->add_option(
            "--max", options->limits,
            "METRIC=VALUE: exit 1 if the error is larger (psnr and ssim: if smaller); metrics: mse, rmse, "
            "psnr, ssim, flip, flip.weighted_median, flip.q1, flip.q3, flip.min, flip.max; may be given "
            "several times")
        ->allow_extra_args(false);
    command->add_flag("--json", options->json,
                      "Print one line of JSON: an object, or for several tests an array of objects");
    command->footer("Examples:\n"
                    "  kestrel compare reference.png test.png --heatmap flip.png\n"
                    "  kestrel compare reference.exr test.exr --max flip=0.05 --json\n"
                    "  kestrel compare reference.exr a.exr b.exr:beauty --heatmap 'flip_{}.png'");
    command->callback([options, &run] { run = [options] { return compareCommand(*options); }; });
}

} // namespace kestrel
