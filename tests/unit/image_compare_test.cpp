// The command is part of an executable; its one translation unit is taken in here.
#include "../../apps/kestrel/compare.cpp"
#include "core/files.h"
#include "image/metrics.h"
#include "support/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace kestrel {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class Compare : public testing::Test {
protected:
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

    test::TemporaryFolder folder_;
    std::string output_;
    std::string complaints_;
    std::string thrown_;
};

TEST_F(Compare, PrintsTheFiguresAsJson) {
    const fs::path a = write("a.png", Image(12, 10, 1, 0));
    const fs::path b = write("b.png", Image(12, 10, 1, 1));
    EXPECT_EQ(run({.reference = a, .tests = {b}, .heatMap = {}, .mask = {}, .limits = {}, .json = true}), 0);
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
    EXPECT_EQ(run({.reference = a, .tests = {a}, .heatMap = {}, .mask = {}, .limits = {}, .json = true}), 0);
    EXPECT_TRUE(nlohmann::json::parse(output_)["psnr"].is_null());
}

TEST_F(Compare, PrintsATable) {
    const fs::path a = write("a.png", Image(8, 8, 3, 0.2F));
    EXPECT_EQ(run({.reference = a, .tests = {a}, .heatMap = {}, .mask = {}, .limits = {}, .json = false}), 0);
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
                    .tests = {b},
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
        run({.reference = a, .tests = {a}, .heatMap = {}, .mask = {}, .limits = {"psnr=1000"}, .json = true}),
        0);
}

TEST_F(Compare, RefusesLimitsItDoesNotUnderstandAllAtOnceAndBeforeReading) {
    EXPECT_EQ(run({.reference = "missing.png",
                   .tests = {"missing.png"},
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

TEST_F(Compare, AValueThatIsNotFiniteIsToldWithItsFile) {
    Image broken(8, 8, 1, 0);
    broken.at(3, 2) = std::numeric_limits<float>::quiet_NaN();
    const fs::path good = write("good.exr", Image(8, 8, 1, 0)), bad = write("bad.exr", broken);
    const std::string message =
        bad.string() + ": the picture has 1 value that is not finite; the first is nan at pixel (3, 2)";
    EXPECT_EQ(run({.reference = good, .tests = {bad}, .heatMap = {}, .mask = {}, .limits = {}}), -1);
    EXPECT_EQ(thrown_, message);
    EXPECT_EQ(run({.reference = bad, .tests = {good}, .heatMap = {}, .mask = {}, .limits = {}}), -1);
    EXPECT_EQ(thrown_, message);
}

TEST_F(Compare, RefusesImagesOfDifferentSizesOrKinds) {
    const fs::path a = write("a.png", Image(8, 8, 1, 0));
    const fs::path b = write("b.png", Image(9, 8, 1, 0));
    const fs::path c = write("c.exr", Image(8, 8, 1, 0));
    EXPECT_EQ(run({.reference = a, .tests = {b}, .heatMap = {}, .mask = {}, .limits = {}, .json = true}), -1);
    EXPECT_EQ(thrown_, b.string() + ": has the size 9x8, but " + a.string() + " has 8x8: they must be equal");
    EXPECT_EQ(run({.reference = a, .tests = {a}, .heatMap = {}, .mask = b, .limits = {}, .json = true}), -1);
    EXPECT_THAT(thrown_, HasSubstr("b.png: has the size 9x8, but "));
    EXPECT_EQ(run({.reference = a, .tests = {c}, .heatMap = {}, .mask = {}, .limits = {}, .json = true}), -1);
    EXPECT_EQ(thrown_, c.string() + ": cannot be compared with " + a.string() +
                           ": one holds linear values (EXR, HDR), the other code values (PNG)");
    EXPECT_EQ(
        run({.reference = a, .tests = {a}, .heatMap = "map.gif", .mask = {}, .limits = {}, .json = true}),
        -1);
    EXPECT_THAT(thrown_, HasSubstr("map.gif: the ending"));
    EXPECT_EQ(output_, "");
}

TEST_F(Compare, ComparesHdrFilesAsHdr) {
    const fs::path a = write("a.exr", Image(8, 8, 3, 4));
    const fs::path b = write("b.hdr", Image(8, 8, 3, 8));
    EXPECT_EQ(run({.reference = a, .tests = {b}, .heatMap = {}, .mask = {}, .limits = {}, .json = true}), 0);
    const ErrorFigures expected = measureError(Image(8, 8, 3, 4), Image(8, 8, 3, 8), {.hdr = true});
    EXPECT_EQ(output_, toJson(expected) + "\n");
    EXPECT_EQ(run({.reference = a, .tests = {b}, .heatMap = {}, .mask = {}, .limits = {}, .json = false}), 0);
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
    EXPECT_EQ(
        run({.reference = a, .tests = {b}, .heatMap = {}, .mask = m, .limits = {"mse=0"}, .json = true}), 0);
    EXPECT_EQ(
        run({.reference = a, .tests = {b}, .heatMap = {}, .mask = {}, .limits = {"mse=0"}, .json = true}), 1);
}

TEST_F(Compare, WritesTheErrorsAsAHeatMapOrAsValues) {
    const fs::path a = write("a.png", Image(6, 4, 1, 0));
    Image half(6, 4, 1, 0);
    for (int y = 0; y < 4; ++y) half.at(5, y) = 1;
    const fs::path b = write("b.png", half);
    const Image errors = flip(Image(6, 4, 1, 0), half).map;
    const fs::path values = folder_ / "new" / "map.exr";
    const fs::path colors = folder_ / "map.png";
    EXPECT_EQ(run({.reference = a, .tests = {b}, .heatMap = values, .mask = {}, .limits = {}, .json = true}),
              0);
    EXPECT_EQ(readImage(values), errors);
    EXPECT_EQ(run({.reference = a, .tests = {b}, .heatMap = colors, .mask = {}, .limits = {}, .json = true}),
              0);
    EXPECT_EQ(readImage(colors), heatMap(errors));
    EXPECT_EQ(run({.reference = a, .tests = {a}, .heatMap = colors, .mask = {}, .limits = {}, .json = true}),
              0);
    EXPECT_EQ(readImage(colors), heatMap(Image(6, 4, 1, 0)));
}

TEST_F(Compare, MeasuresSeveralTestsInATable) {
    const fs::path a = write("a.png", Image(12, 8, 1, 0));
    const fs::path b = write("b.png", Image(12, 8, 1, 1));
    const fs::path c = write("c.png", Image(12, 8, 1, 0.2F));
    EXPECT_EQ(run({.reference = a, .tests = {a, b}, .heatMap = {}, .mask = {}, .limits = {}, .json = false}),
              0);
    std::istringstream lines(output_);
    std::vector<std::string> line(5);
    for (std::string& text : line) std::getline(lines, text);
    EXPECT_EQ(line[0], "against " + a.string() + ", LDR");
    EXPECT_THAT(line[1],
                testing::ContainsRegex("^test +MSE +PSNR .dB. +SSIM +FLIP mean +FLIP median +FLIP max$"));
    EXPECT_THAT(line[2], testing::ContainsRegex("^" + a.string() + " +0 +inf +1 +0 +0 +0$"));
    EXPECT_THAT(line[3], testing::ContainsRegex("^" + b.string() + " +1 +0 +9.999e-05 +0.9"));
    EXPECT_EQ(line[4], "");
    EXPECT_EQ(line[1].size(), line[2].size());
    EXPECT_EQ(line[1].size(), line[3].size());

    // Limits hold for each; each that misses is named.
    EXPECT_EQ(run({.reference = a,
                   .tests = {b, a, c},
                   .heatMap = {},
                   .mask = {},
                   .limits = {"mse=0.01"},
                   .json = false}),
              1);
    EXPECT_EQ(complaints_, b.string() + ": mse is 1, above the maximum 0.01\n" + c.string() +
                               ": mse is 0.04, above the maximum 0.01\n");
}

TEST_F(Compare, PrintsSeveralTestsAsAnArray) {
    const fs::path a = write("a.png", Image(12, 8, 1, 0));
    const fs::path b = write("b.png", Image(12, 8, 1, 1));
    EXPECT_EQ(run({.reference = a, .tests = {b, a}, .heatMap = {}, .mask = {}, .limits = {}, .json = true}),
              0);
    const auto json = nlohmann::ordered_json::parse(output_);
    ASSERT_EQ(json.size(), 2U);
    EXPECT_EQ(json[0].begin().key(), "test");
    EXPECT_EQ(json[0]["test"], b.string());
    EXPECT_EQ(json[0]["mse"], 1.0);
    EXPECT_EQ(json[1]["test"], a.string());
    EXPECT_EQ(json[1]["flip"]["max"], 0.0);
    // Apart from the name, the object of a test is that of the test alone.
    EXPECT_EQ(run({.reference = a, .tests = {b}, .heatMap = {}, .mask = {}, .limits = {}, .json = true}), 0);
    auto alone = nlohmann::ordered_json::parse(output_);
    auto first = json[0];
    first.erase("test");
    EXPECT_EQ(first, alone);
}

TEST_F(Compare, TellsAllThatIsWrongAndMeasuresTheRest) {
    const fs::path a = write("a.png", Image(12, 8, 1, 0));
    const fs::path b = write("b.png", Image(9, 8, 1, 1));
    const fs::path c = write("c.exr", Image(12, 8, 1, 1));
    const fs::path gone = folder_ / "gone.png";
    EXPECT_EQ(run({.reference = a,
                   .tests = {b, a, gone, c},
                   .heatMap = {},
                   .mask = {},
                   .limits = {},
                   .json = true}),
              -1);
    EXPECT_EQ(thrown_, b.string() + ": has the size 9x8, but " + a.string() +
                           " has 12x8: they must be equal\n" + gone.string() + ": no such file\n" +
                           c.string() + ": cannot be compared with " + a.string() +
                           ": one holds linear values (EXR, HDR), the other code values (PNG)");
    EXPECT_EQ(nlohmann::json::parse(output_).size(), 1U);
}

TEST_F(Compare, WritesAHeatMapATest) {
    const fs::path a = write("a.png", Image(6, 4, 1, 0));
    const fs::path b = write("b.png", Image(6, 4, 1, 1));
    const std::string pattern = (folder_ / "maps" / "flip_{}.exr").string();
    EXPECT_EQ(
        run({.reference = a, .tests = {a, b}, .heatMap = pattern, .mask = {}, .limits = {}, .json = true}),
        0);
    EXPECT_EQ(readImage(folder_ / "maps" / "flip_a.exr"), Image(6, 4, 1, 0));
    EXPECT_EQ(readImage(folder_ / "maps" / "flip_b.exr"), flip(Image(6, 4, 1, 0), Image(6, 4, 1, 1)).map);
    EXPECT_EQ(
        run({.reference = a, .tests = {a, b}, .heatMap = "flip.png", .mask = {}, .limits = {}, .json = true}),
        -1);
    EXPECT_EQ(thrown_,
              "--heatmap flip.png: for several tests it needs '{}' in its name, which stands for the "
              "test's");
    EXPECT_EQ(run({.reference = a,
                   .tests = {b, a, b},
                   .heatMap = "{}.png",
                   .mask = {},
                   .limits = {},
                   .json = true}),
              -1);
    EXPECT_EQ(thrown_,
              "--heatmap {}.png: the tests " + b.string() + " and " + b.string() + " would both write b.png");
    EXPECT_EQ(output_, "");
}

TEST_F(Compare, NamesLayersAndTellsPicturesByTheirBytes) {
    const Image grey(6, 4, 3, 0.5F);
    const fs::path a = write("a.exr", grey);
    const fs::path odd = folder_ / "a:b.exr"; // a colon of its own
    writeImage(odd, grey, Encoding::Linear);
    const fs::path radiance = folder_ / "a.pic";
    writeFile(radiance, encodeImage(grey, ImageFormat::Hdr, Encoding::Linear));
    for (const std::string& test : {a.string() + ":R", odd.string(), odd.string() + ":G", radiance.string()})
        EXPECT_EQ(run({.reference = a,
                       .tests = {test},
                       .heatMap = {},
                       .mask = {},
                       .limits = {"mse=0"},
                       .json = true}),
                  0)
            << test << thrown_ << complaints_;
    EXPECT_EQ(run({.reference = a,
                   .tests = {a.string() + ":rgb"},
                   .heatMap = {},
                   .mask = {},
                   .limits = {},
                   .json = true}),
              -1);
    EXPECT_EQ(thrown_, a.string() + ": has no layer 'rgb'; it has the channels 'B', 'G', 'R'");
}

} // namespace
} // namespace kestrel
