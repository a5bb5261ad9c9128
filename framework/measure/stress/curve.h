// Stability as a curve: one number of a stress case over decades, and how far each technique's picture is off
// at each of its values. The third axis beside error and time.
#pragma once
#include "measure/stress/stress_case.h"
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace kestrel {

struct StressCurve {
    std::string_view name; // "place"
    std::string_view does; // one sentence without full stop
    std::string_view axis; // what the number is, with its unit
    std::vector<double> values;
    // Whether the number has nothing to do with the picture. Then each technique is held against its own
    // plain picture; else against its picture of the same triangles in the opposite order, which may differ
    // no more.
    bool staysSame = true;
    StressCase (*at)(double value);
};
[[nodiscard]] const std::vector<StressCurve>& stressCurves();
// Throws InputError with the near name.
[[nodiscard]] const StressCurve& stressCurve(const std::string& name);

// What is rendered of a curve, as cases for workers (stress_workers.h): the scene as it is, from one seed and
// from another, and at each value, its triangles as they are or in the opposite order.
enum class CurvePicture : std::uint8_t { Plain, Seed, At, Reversed };
[[nodiscard]] std::string curveCaseName(const StressCurve& curve, CurvePicture picture, double value);
// The case of such a name; nothing if it is none.
[[nodiscard]] std::optional<StressCase> curveCase(std::string_view name);

// ---- what was found

inline constexpr double notMeasured = std::numeric_limits<double>::quiet_NaN();

// Distances are relative: root mean square of the difference over that of the picture that it is held
// against, where the mask counts. Infinite where a picture holds what is no number, or there is none.
struct CurvePoint {
    double value = 0;
    double own = notMeasured;   // to the technique's own plain picture, or that in opposite order
    double truth = notMeasured; // to the reference's picture, if there is a reference
    std::string why = {};       // of a crash, a hang, a refusal, values that are not finite or out of range
    friend bool operator==(const CurvePoint&, const CurvePoint&) = default;
};

struct CurveSeries {
    std::string name = {}, command = {};
    CurvePoint plain = {}; // without the case: `own` is the distance of two seeds
    std::vector<CurvePoint> points = {};
};

struct CurvePlot {
    std::string scene = {};
    bool hasTruth = false;
    std::vector<CurveSeries> series = {};
};

struct CurveResults {
    std::string curve = {}, title = {}, file = {}, size = {}, renderer = {};
    int frames = 1;
    std::vector<CurvePlot> plots = {};
};

// {"kestrel_curve":1,"case","axis","title","file","size","frames","renderer","plots":[{"scene","series":[{"name",
// "command","plain":{"own","truth"},"points":[{"value","own","truth","why"}]}]}]}; null: infinite; keys are
// only ever added.
[[nodiscard]] std::string curveJson(const CurveResults& results);
// A table a plot, for people.
[[nodiscard]] std::string curveText(const CurveResults& results);
// One plot as a picture of its own: over the number, on the left how far each technique is off its own plain
// picture, on the right how far off the reference.
[[nodiscard]] std::string curveSvg(const CurveResults& results, const CurvePlot& plot);
// One page without outside links.
[[nodiscard]] std::string curvePage(const CurveResults& results);

} // namespace kestrel
