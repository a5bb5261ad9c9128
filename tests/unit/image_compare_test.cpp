// The command is part of an executable; its one translation unit is taken in here.
#include "../../apps/kestrel/compare.cpp"
#include "core/files.h"
#include "image/metrics.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace kestrel {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class Compare : public testing::Test {
protected:
    Compare()
        : folder_(fs::path(testing::TempDir()) /
                  (std::string("kestrel_compare_") +
                   testing::UnitTest::GetInstance()->current_test_info()->name())) {
        fs::create_directories(folder_);
    }
    ~Compare() override { fs::remove_all(folder_); }

    fs::path write(const std::string& name, const Image& image) {
        const fs::path file = folder_ / name;
        writeImage(file, image, Encoding::Linear);
        return file;
    }

    // Runs the command, keeping what it prints.
    int run(const CompareOptions& options) {
        testing::internal::CaptureStdout();
        testing::internal::CaptureStderr();
        int status = -1;
        try {
            status = compareCommand(options);
        } catch (const InputError& error) {
            thrown_ = error.what();
        }
        output_ = testing::internal::GetCapturedStdout();
        complaints_ = testing::internal::GetCapturedStderr();
        return status;
    }

    fs::path folder_;
    std::string output_;
    std::string complaints_;
    std::string thrown_;
};

TEST_F(Compare, PrintsTheFiguresAsJson) {
    const fs::path a = write("a.png", Image(12, 10, 1, 0));
    const fs::path b = write("b.png", Image(12, 10, 1, 1));
    EXPECT_EQ(run({.reference = a, .test = b, .heatMap = {}, .mask = {}, .limits = {}, .json = true}), 0);
    EXPECT_EQ(std::count(output_.begin(), output_.end(), '\n'), 1);
    const auto json = nlohmann::ordered_json::parse(output_);
    std::vector<std::string> keys;
    for (const auto& [key, value] : json.items()) keys.push_back(key);
    for (const auto& [key, value] : json["flip"].items()) keys.push_back("flip." + key);
    EXPECT_EQ(keys, (std::vector<std::string>{"mse", "rmse", "psnr", "ssim", "flip", "flip.mean",
                                              "flip.weighted_median", "flip.q1", "flip.q3", "flip.min",
                                              "flip.max"}));
    EXPECT_EQ(json["mse"], 1.0);
    EXPECT_EQ(json["rmse"], 1.0);
    EXPECT_EQ(json["psnr"], 0.0);
    EXPECT_NEAR(json["ssim"], 1e-4 / (1 + 1e-4), 1e-7);
    EXPECT_GT(json["flip"]["mean"], 0.95);
    EXPECT_EQ(run({.reference = a, .test = a, .heatMap = {}, .mask = {}, .limits = {}, .json = true}), 0);
    EXPECT_TRUE(nlohmann::json::parse(output_)["psnr"].is_null());
}

TEST_F(Compare, PrintsATable) {
    const fs::path a = write("a.png", Image(8, 8, 3, 0.2F));
    EXPECT_EQ(run({.reference = a, .test = a, .heatMap = {}, .mask = {}, .limits = {}, .json = false}), 0);
    EXPECT_THAT(output_, HasSubstr(a.string() + " against " + a.string() + ", LDR\n"));
    EXPECT_THAT(output_, HasSubstr("  MSE                                    0\n"));
    EXPECT_THAT(output_, HasSubstr("  PSNR (dB)                            inf\n"));
    EXPECT_THAT(output_, HasSubstr("  SSIM                                   1\n"));
    EXPECT_THAT(output_, HasSubstr("  FLIP weighted 3rd quartile             0\n"));
    EXPECT_EQ(complaints_, "");
}

TEST_F(Compare, FailsWhereALimitIsMissedAndSaysWhich) {
    const fs::path a = write("a.png", Image(8, 8, 1, 0));
    const fs::path b = write("b.png", Image(8, 8, 1, 1));
    const auto withLimits = [&](std::vector<std::string> limits) {
        return run({.reference = a,
                    .test = b,
                    .heatMap = {},
                    .mask = {},
                    .limits = std::move(limits),
                    .json = true});
    };
    EXPECT_EQ(withLimits({"flip=1", "mse=1", "rmse=1.5", "psnr=0", "ssim=0", "flip.max=1e0"}), 0);
    EXPECT_EQ(complaints_, "");
    EXPECT_EQ(withLimits({"mse=0.5"}), 1);
    EXPECT_EQ(complaints_, b.string() + ": mse is 1, above the maximum 0.5\n");
    EXPECT_FALSE(output_.empty()); // the figures are printed all the same
    EXPECT_EQ(withLimits({"psnr=30", "ssim=0.9", "rmse=2"}), 1);
    EXPECT_EQ(complaints_,
              b.string() + ": psnr is 0, below the minimum 30; ssim is 9.999e-05, below the minimum 0.9\n");
    EXPECT_EQ(withLimits({"flip=0.1"}), 1);
    EXPECT_THAT(complaints_, HasSubstr(": flip is 0.9"));
    EXPECT_EQ(
        run({.reference = a, .test = a, .heatMap = {}, .mask = {}, .limits = {"psnr=1000"}, .json = true}),
        0);
}

TEST_F(Compare, RefusesLimitsItDoesNotUnderstandAllAtOnceAndBeforeReading) {
    EXPECT_EQ(run({.reference = "missing.png",
                   .test = "missing.png",
                   .heatMap = {},
                   .mask = {},
                   .limits = {"flipp=0.1", "mse", "rmse=much", "ssim=nan", "psnr=1dB"},
                   .json = true}),
              -1);
    EXPECT_EQ(thrown_, "unknown metric 'flipp' in the limit 'flipp=0.1' (did you mean 'flip'?)\n"
                       "the limit 'mse' is not of the form METRIC=VALUE\n"
                       "the value of the limit 'rmse=much' is not a finite number\n"
                       "the value of the limit 'ssim=nan' is not a finite number\n"
                       "the value of the limit 'psnr=1dB' is not a finite number");
}

TEST_F(Compare, RefusesImagesOfDifferentSizesOrKinds) {
    const fs::path a = write("a.png", Image(8, 8, 1, 0));
    const fs::path b = write("b.png", Image(9, 8, 1, 0));
    const fs::path c = write("c.exr", Image(8, 8, 1, 0));
    EXPECT_EQ(run({.reference = a, .test = b, .heatMap = {}, .mask = {}, .limits = {}, .json = true}), -1);
    EXPECT_EQ(thrown_, b.string() + ": has the size 9x8, but " + a.string() + " has 8x8: they must be equal");
    EXPECT_EQ(run({.reference = a, .test = a, .heatMap = {}, .mask = b, .limits = {}, .json = true}), -1);
    EXPECT_THAT(thrown_, HasSubstr("b.png: has the size 9x8, but "));
    EXPECT_EQ(run({.reference = a, .test = c, .heatMap = {}, .mask = {}, .limits = {}, .json = true}), -1);
    EXPECT_EQ(thrown_, c.string() + ": cannot be compared with " + a.string() +
                           ": one holds linear values (.exr, .hdr), the other code values (.png)");
    EXPECT_EQ(run({.reference = a, .test = a, .heatMap = "map.gif", .mask = {}, .limits = {}, .json = true}),
              -1);
    EXPECT_THAT(thrown_, HasSubstr("map.gif: the ending"));
    EXPECT_EQ(output_, "");
}

TEST_F(Compare, ComparesHdrFilesAsHdr) {
    const fs::path a = write("a.exr", Image(8, 8, 3, 4));
    const fs::path b = write("b.hdr", Image(8, 8, 3, 8));
    EXPECT_EQ(run({.reference = a, .test = b, .heatMap = {}, .mask = {}, .limits = {}, .json = true}), 0);
    const ErrorFigures expected = measureError(Image(8, 8, 3, 4), Image(8, 8, 3, 8), {.hdr = true});
    EXPECT_EQ(output_, toJson(expected) + "\n");
    EXPECT_EQ(run({.reference = a, .test = b, .heatMap = {}, .mask = {}, .limits = {}, .json = false}), 0);
    EXPECT_THAT(output_, HasSubstr(", HDR\n"));
}

TEST_F(Compare, CountsOnlyTheMask) {
    Image test(40, 8, 1, 0);
    Image mask(40, 8, 3, 1);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
            test.at(x, y) = 1;
            for (int channel = 0; channel < 3; ++channel) mask.at(x, y, channel) = 0;
        }
    const fs::path a = write("a.png", Image(40, 8, 1, 0));
    const fs::path b = write("b.png", test);
    const fs::path m = write("m.png", mask);
    EXPECT_EQ(run({.reference = a, .test = b, .heatMap = {}, .mask = m, .limits = {"mse=0"}, .json = true}),
              0);
    EXPECT_EQ(run({.reference = a, .test = b, .heatMap = {}, .mask = {}, .limits = {"mse=0"}, .json = true}),
              1);
}

TEST_F(Compare, WritesTheErrorsAsAHeatMapOrAsValues) {
    const fs::path a = write("a.png", Image(6, 4, 1, 0));
    Image half(6, 4, 1, 0);
    for (int y = 0; y < 4; ++y) half.at(5, y) = 1;
    const fs::path b = write("b.png", half);
    const Image errors = flip(Image(6, 4, 1, 0), half).map;
    const fs::path values = folder_ / "new" / "map.exr";
    const fs::path colors = folder_ / "map.png";
    EXPECT_EQ(run({.reference = a, .test = b, .heatMap = values, .mask = {}, .limits = {}, .json = true}), 0);
    EXPECT_EQ(readImage(values), errors);
    EXPECT_EQ(run({.reference = a, .test = b, .heatMap = colors, .mask = {}, .limits = {}, .json = true}), 0);
    EXPECT_EQ(readImage(colors), heatMap(errors));
    EXPECT_EQ(run({.reference = a, .test = a, .heatMap = colors, .mask = {}, .limits = {}, .json = true}), 0);
    EXPECT_EQ(readImage(colors), heatMap(Image(6, 4, 1, 0)));
}

} // namespace
} // namespace kestrel
