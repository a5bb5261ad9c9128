#include "compare.h"
#include "core/error.h"
#include "core/files.h"
#include "image/colormap.h"
#include "image/error_figures.h"
#include "image/io.h"
#include "image/metrics.h"
#include "say.h"
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

namespace kestrel {
namespace {

struct Metric {
    std::string_view name;  // in a limit
    std::string_view title; // in the table of one test
    double (*value)(const ErrorFigures&);
    bool greaterIsBetter = false;
    std::string_view column = {}; // in the table of several tests; empty: not in it
};

constexpr std::array<Metric, 10> metrics{
    {{"mse", "MSE", [](const ErrorFigures& f) { return f.mse; }, false, "MSE"},
     {"rmse", "RMSE", [](const ErrorFigures& f) { return f.rmse; }},
     {"psnr", "PSNR (dB)", [](const ErrorFigures& f) { return f.psnr; }, true, "PSNR (dB)"},
     {"ssim", "SSIM", [](const ErrorFigures& f) { return f.ssim; }, true, "SSIM"},
     {"flip.mean", "FLIP mean", [](const ErrorFigures& f) { return f.flip.mean; }, false, "FLIP mean"},
     {"flip.weighted_median", "FLIP weighted median",
      [](const ErrorFigures& f) { return f.flip.weightedMedian; }, false, "FLIP median"},
     {"flip.q1", "FLIP weighted 1st quartile", [](const ErrorFigures& f) { return f.flip.q1; }},
     {"flip.q3", "FLIP weighted 3rd quartile", [](const ErrorFigures& f) { return f.flip.q3; }},
     {"flip.min", "FLIP minimum", [](const ErrorFigures& f) { return f.flip.min; }},
     {"flip.max", "FLIP maximum", [](const ErrorFigures& f) { return f.flip.max; }, false, "FLIP max"}}};

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

struct Measured {
    std::string test;
    ErrorFigures figures;
};

void requireSameSizes(const Image& reference, const Image& other, const CompareOptions& options,
                      const std::filesystem::path& otherFile) {
    if (reference.sameSize(other)) return;
    throw InputError(Location{otherFile.string()},
                     fmt::format("has the size {}, but {} has {}: they must be equal", other.sizeText(),
                                 options.reference.string(), reference.sizeText()));
}

void requireSameKind(const Picture& reference, const Picture& test, const CompareOptions& options,
                     const std::filesystem::path& testFile) {
    if (holdsHighDynamicRange(reference.format) != holdsHighDynamicRange(test.format))
        throw InputError(Location{testFile.string()},
                         fmt::format("cannot be compared with {}: one holds linear values (EXR, HDR), the "
                                     "other code values (PNG)",
                                     options.reference.string()));
}

// The file of a test's heat map: "{}" in the pattern is the test's name, and its layer's.
std::string heatMapName(const std::string& pattern, const std::filesystem::path& test) {
    std::string name = pattern;
    const ImageName parts = imageName(test);
    std::string stem = parts.file.stem().string();
    if (!parts.layer.empty()) stem += "." + parts.layer;
    std::replace(stem.begin(), stem.end(), '/', '_');
    for (std::size_t at = name.find("{}"); at != std::string::npos; at = name.find("{}", at + stem.size()))
        name.replace(at, 2, stem);
    return name;
}

// Before the long work: whether every test's heat map has a file of its own that can be written.
void checkHeatMaps(const CompareOptions& options) {
    if (options.heatMap.empty()) return;
    static_cast<void>(imageFormat(std::filesystem::path(options.heatMap)));
    std::map<std::string, std::string> owners;
    for (const std::filesystem::path& test : options.tests) {
        const std::string name = heatMapName(options.heatMap, test);
        const auto [owner, fresh] = owners.emplace(name, test.string());
        if (fresh) {
            requireWritable(name);
            continue;
        }
        if (options.heatMap.find("{}") == std::string::npos)
            throw InputError(fmt::format("--heatmap {}: for several tests it needs '{{}}' in its name, which "
                                         "stands for the test's",
                                         options.heatMap));
        throw InputError(fmt::format("--heatmap {}: the tests {} and {} would both write {}", options.heatMap,
                                     owner->second, test.string(), name));
    }
}

void printFigures(const ErrorFigures& figures, const CompareOptions& options, const std::string& head) {
    say("{} against {}\n", options.tests[0].string(), head);
    for (const Metric& metric : metrics) say("  {:<28}{:>12.6g}\n", metric.title, metric.value(figures));
}

void printRows(const std::vector<Measured>& measured, const std::string& head) {
    std::size_t width = 4;
    for (const Measured& one : measured) width = std::max(width, one.test.size());
    say("against {}\n{:<{}}", head, "test", width);
    for (const Metric& metric : metrics)
        if (!metric.column.empty()) say("{:>13}", metric.column);
    for (const Measured& one : measured) {
        say("\n{:<{}}", one.test, width);
        for (const Metric& metric : metrics)
            if (!metric.column.empty()) say("{:>13.6g}", metric.value(one.figures));
    }
    say("\n");
}

void print(const std::vector<Measured>& measured, const CompareOptions& options, bool hdr) {
    const bool several = options.tests.size() > 1;
    if (options.json && several) {
        nlohmann::ordered_json all = nlohmann::ordered_json::array();
        for (const Measured& one : measured) {
            nlohmann::ordered_json object{{"test", one.test}};
            object.update(nlohmann::ordered_json::parse(toJson(one.figures)));
            all.push_back(std::move(object));
        }
        fmt::print("{}\n", all.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    } else if (options.json) {
        fmt::print("{}\n", toJson(measured[0].figures));
    } else {
        const std::string head =
            fmt::format("{}, {}{}", options.reference.string(), hdr ? "HDR" : "LDR",
                        options.mask.empty() ? "" : ", where " + options.mask.string() + " > 0.5");
        several ? printRows(measured, head) : printFigures(measured[0].figures, options, head);
    }
    std::fflush(stdout);
}

void writeHeatMap(const std::filesystem::path& file, const Image& errors) {
    const bool values = holdsHighDynamicRange(imageFormat(file));
    writeImage(file, values ? errors : heatMap(errors), Encoding::Linear);
}

// The reference and the mask, which serve every test.
struct Measure {
    const CompareOptions& options;
    Picture reference;
    std::optional<Image> mask;

    explicit Measure(const CompareOptions& chosen)
        : options(chosen)
        , reference(readPicture(chosen.reference)) {
        requireFinite(reference.image, "picture", chosen.reference.string());
        if (chosen.mask.empty()) return;
        mask = convertChannels(readImage(chosen.mask), 1);
        requireSameSizes(reference.image, *mask, chosen, chosen.mask);
    }
    [[nodiscard]] bool hdr() const { return holdsHighDynamicRange(reference.format); }

    [[nodiscard]] ErrorFigures operator()(const std::filesystem::path& test) const {
        const Picture picture = readPicture(test);
        requireSameKind(reference, picture, options, test);
        requireSameSizes(reference.image, picture.image, options, test);
        requireFinite(picture.image, "picture", test.string());
        Image errors;
        const ErrorFigures figures = measureError(reference.image, picture.image,
                                                  {.hdr = hdr(), .mask = mask ? &*mask : nullptr}, &errors);
        if (!options.heatMap.empty()) writeHeatMap(heatMapName(options.heatMap, test), errors);
        return figures;
    }
};

// Whether each test keeps each limit; a line about each that does not.
bool keepsLimits(const std::vector<Measured>& measured, const std::vector<Limit>& limits) {
    bool kept = true;
    for (const Measured& one : measured) {
        std::vector<std::string> complaints;
        for (const Limit& limit : limits)
            if (const auto complaint = missed(limit, one.figures)) complaints.push_back(*complaint);
        if (complaints.empty()) continue;
        kept = false;
        fmt::print(stderr, "{}: {}\n", one.test, fmt::join(complaints, "; "));
    }
    return kept;
}

} // namespace

int compareCommand(const CompareOptions& options) {
    const std::vector<Limit> limits = parseLimits(options.limits);
    checkHeatMaps(options);
    const Measure measure(options);
    std::vector<Measured> measured;
    std::vector<Problem> problems;
    for (const std::filesystem::path& test : options.tests) try {
            measured.push_back({test.string(), measure(test)});
        } catch (const InputError& error) {
            problems.insert(problems.end(), error.problems().begin(), error.problems().end());
        }
    if (!measured.empty()) print(measured, options, measure.hdr());
    const bool kept = keepsLimits(measured, limits);
    if (!problems.empty()) throw InputError(std::move(problems));
    return static_cast<int>(kept ? ExitStatus::Done : ExitStatus::MeasureFailed);
}

} // namespace kestrel
