#include "measure/stress/curve.h"
#include <algorithm>
#include <charconv>
#include <fmt/format.h>

namespace kestrel {
namespace {

std::vector<double> decades(int from, int to) {
    std::vector<double> values;
    for (int e = from; e <= to; ++e) values.push_back(std::stod(fmt::format("1e{}", e)));
    return values;
}

constexpr glm::dvec3 away(0.75, -0.55, 0.37); // along no axis, of length 1

StressCase scaled(double value) { return {.edit = {.scale = value}}; }
StressCase moved(double value) { return {.edit = {.move = value * away}}; }
StressCase offCentre(double value) { return {.edit = {.offCentre = value}}; }

// The far plane stays where it is, ten thousand times as far as the scene's near plane.
StressCase farOverNear(double value) { return {.edit = {.nearFactor = 1e4 / value, .farOverNear = value}}; }

StressCase layered(double value) {
    return {.scene = fmt::format("builtin:stress_layers?count={}", std::max(1, static_cast<int>(value)))};
}

constexpr std::string_view prefix = "curve/";

} // namespace

const std::vector<StressCurve>& stressCurves() {
    static const std::vector<StressCurve> curves = {
        {.name = "scale",
         .does = "The scene and all lengths among the properties larger or smaller",
         .axis = "scale of the scene",
         .values = decades(-9, 9),
         .at = scaled},
        {.name = "place",
         .does = "The scene as a whole elsewhere",
         .axis = "the scene's distance from where it was, in its radii",
         .values = decades(0, 15),
         .at = moved},
        {.name = "off_centre",
         .does = "The scene away from the origin of the coordinates that shaders see, since a small triangle "
                 "lies "
                 "as far on the other side",
         .axis = "the scene's distance from the middle of all triangles, in its radii",
         .values = decades(0, 8),
         .at = offCentre},
        {.name = "far_over_near",
         .does =
             "The near plane nearer and nearer to the eye, the far plane 1e4 of the scene's near planes away",
         .axis = "far plane over near plane",
         .values = decades(4, 14),
         .at = farOverNear},
        {.name = "layers",
         .does = "Squares one behind the other",
         .axis = "surfaces behind a pixel",
         .values = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000},
         .staysSame = false,
         .at = layered},
    };
    return curves;
}

const StressCurve& stressCurve(const std::string& name) {
    std::vector<std::string> names;
    for (const StressCurve& curve : stressCurves()) {
        if (curve.name == name) return curve;
        names.emplace_back(curve.name);
    }
    throw InputError(fmt::format("--curve {}: there is no such curve{}; there are {}", name,
                                 didYouMean(name, names), fmt::join(names, ", ")));
}

std::string curveCaseName(const StressCurve& curve, CurvePicture picture, double value) {
    std::string begin = fmt::format("{}{}/", prefix, curve.name);
    switch (picture) {
    case CurvePicture::Plain:
        return begin + "plain";
    case CurvePicture::Seed:
        return begin + "seed";
    case CurvePicture::At:
        return fmt::format("{}{}", begin, value);
    case CurvePicture::Reversed:
        return fmt::format("{}{}/reversed", begin, value);
    }
    return begin;
}

std::optional<StressCase> curveCase(std::string_view name) {
    if (!name.starts_with(prefix)) return {};
    const std::string_view rest = name.substr(prefix.size());
    const size_t slash = rest.find('/');
    if (slash == std::string_view::npos) return {};
    const auto curve = std::ranges::find(stressCurves(), rest.substr(0, slash), &StressCurve::name);
    if (curve == stressCurves().end()) return {};
    const std::string_view word = rest.substr(slash + 1);
    StressCase one;
    if (word == "seed") {
        one.seed = 1;
    } else if (word != "plain") {
        double value = 0;
        const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
        const std::string_view left(end, static_cast<size_t>(word.data() + word.size() - end));
        if (failure != std::errc() || !(left.empty() || left == "/reversed")) return {};
        one = curve->at(value);
        if (!left.empty()) one.edit.triangles = SceneEdit::Triangles::Reversed;
    }
    one.name = name;
    return one;
}

} // namespace kestrel
