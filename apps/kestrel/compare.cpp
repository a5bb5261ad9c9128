#include "compare.h"
#include "core/error.h"
#include "image/colormap.h"
#include "image/error_figures.h"
#include "image/io.h"
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <optional>
#include <string_view>

namespace kestrel {
namespace {

struct Metric {
    std::string_view name;  // in a limit
    std::string_view title; // in the table
    double (*value)(const ErrorFigures&);
    bool greaterIsBetter = false;
};

constexpr std::array<Metric, 10> metrics{
    {{"mse", "MSE", [](const ErrorFigures& f) { return f.mse; }},
     {"rmse", "RMSE", [](const ErrorFigures& f) { return f.rmse; }},
     {"psnr", "PSNR (dB)", [](const ErrorFigures& f) { return f.psnr; }, true},
     {"ssim", "SSIM", [](const ErrorFigures& f) { return f.ssim; }, true},
     {"flip.mean", "FLIP mean", [](const ErrorFigures& f) { return f.flip.mean; }},
     {"flip.weighted_median", "FLIP weighted median",
      [](const ErrorFigures& f) { return f.flip.weightedMedian; }},
     {"flip.q1", "FLIP weighted 1st quartile", [](const ErrorFigures& f) { return f.flip.q1; }},
     {"flip.q3", "FLIP weighted 3rd quartile", [](const ErrorFigures& f) { return f.flip.q3; }},
     {"flip.min", "FLIP minimum", [](const ErrorFigures& f) { return f.flip.min; }},
     {"flip.max", "FLIP maximum", [](const ErrorFigures& f) { return f.flip.max; }}}};

struct Limit {
    std::string text; // the metric as the user named it
    const Metric* metric = nullptr;
    double value = 0;
};

const Metric* findMetric(std::string_view name) {
    if (name == "flip") name = "flip.mean";
    for (const Metric& metric : metrics)
        if (metric.name == name) return &metric;
    return nullptr;
}

std::optional<double> parseNumber(std::string_view text) {
    double value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

std::vector<Limit> parseLimits(const std::vector<std::string>& texts) {
    std::vector<std::string> names{"flip"};
    for (const Metric& metric : metrics) names.emplace_back(metric.name);
    std::vector<Problem> problems;
    std::vector<Limit> limits;
    for (const std::string& text : texts) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos) {
            problems.push_back({{}, fmt::format("the limit '{}' is not of the form METRIC=VALUE", text)});
            continue;
        }
        const std::string name = text.substr(0, equals);
        const Metric* metric = findMetric(name);
        if (metric == nullptr)
            problems.push_back({{},
                                fmt::format("unknown metric '{}' in the limit '{}'{}", name, text,
                                            didYouMean(name, names))});
        const std::optional<double> value = parseNumber(std::string_view(text).substr(equals + 1));
        if (!value)
            problems.push_back({{}, fmt::format("the value of the limit '{}' is not a finite number", text)});
        if (metric != nullptr && value) limits.push_back({name, metric, *value});
    }
    if (!problems.empty()) throw InputError(std::move(problems));
    return limits;
}

// "flip is 0.2, above the maximum 0.1", or nothing.
std::optional<std::string> missed(const Limit& limit, const ErrorFigures& figures) {
    const double value = limit.metric->value(figures);
    const bool greater = limit.metric->greaterIsBetter;
    if (greater ? value >= limit.value : value <= limit.value) return std::nullopt;
    return fmt::format("{} is {:.6g}, {} {:.6g}", limit.text, value,
                       greater ? "below the minimum" : "above the maximum", limit.value);
}

Image readMask(const std::filesystem::path& file) { return convertChannels(readImage(file), 1); }

void requireSameSizes(const Image& reference, const Image& other, const CompareOptions& options,
                      const std::filesystem::path& otherFile) {
    if (reference.sameSize(other)) return;
    throw InputError(Location{otherFile.string()},
                     fmt::format("has the size {}, but {} has {}: they must be equal", other.sizeText(),
                                 options.reference.string(), reference.sizeText()));
}

bool comparesAsHdr(const CompareOptions& options) {
    const bool reference = holdsHighDynamicRange(imageFormat(options.reference));
    const bool test = holdsHighDynamicRange(imageFormat(options.test));
    if (reference != test)
        throw InputError(
            Location{options.test.string()},
            fmt::format("cannot be compared with {}: one holds linear values (.exr, .hdr), the other "
                        "code values (.png)",
                        options.reference.string()));
    return reference;
}

void printTable(const ErrorFigures& figures, const CompareOptions& options, bool hdr) {
    fmt::print("{} against {}, {}{}\n", options.test.string(), options.reference.string(),
               hdr ? "HDR" : "LDR",
               options.mask.empty() ? "" : ", where " + options.mask.string() + " > 0.5");
    for (const Metric& metric : metrics)
        fmt::print("  {:<28}{:>12.6g}\n", metric.title, metric.value(figures));
}

void writeHeatMap(const std::filesystem::path& file, const Image& errors) {
    const bool values = holdsHighDynamicRange(imageFormat(file));
    writeImage(file, values ? errors : heatMap(errors), Encoding::Linear);
}

} // namespace

int compareCommand(const CompareOptions& options) {
    const std::vector<Limit> limits = parseLimits(options.limits);
    const bool hdr = comparesAsHdr(options);
    if (!options.heatMap.empty()) static_cast<void>(imageFormat(options.heatMap)); // before the long work
    const Image reference = readImage(options.reference);
    const Image test = readImage(options.test);
    requireSameSizes(reference, test, options, options.test);
    std::optional<Image> mask;
    if (!options.mask.empty()) {
        mask = readMask(options.mask);
        requireSameSizes(reference, *mask, options, options.mask);
    }

    Image errors;
    const ErrorFigures figures =
        measureError(reference, test, {.hdr = hdr, .mask = mask ? &*mask : nullptr}, &errors);
    if (!options.heatMap.empty()) writeHeatMap(options.heatMap, errors);
    if (options.json)
        fmt::print("{}\n", toJson(figures));
    else
        printTable(figures, options, hdr);
    std::fflush(stdout);

    std::vector<std::string> complaints;
    for (const Limit& limit : limits)
        if (const auto complaint = missed(limit, figures)) complaints.push_back(*complaint);
    if (complaints.empty()) return static_cast<int>(ExitStatus::Done);
    fmt::print(stderr, "{}: {}\n", options.test.string(), fmt::join(complaints, "; "));
    return static_cast<int>(ExitStatus::MeasureFailed);
}

} // namespace kestrel
