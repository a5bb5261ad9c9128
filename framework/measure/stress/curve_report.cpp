// What a curve found: as JSON, as a table for people, and as a page.
#include "measure/page_html.h"
#include "measure/stress/curve.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace kestrel {
namespace {

using Out = nlohmann::ordered_json;

void addPoint(Out& json, const CurvePoint& point) {
    const auto number = [](double value) { return std::isfinite(value) ? Out(value) : Out(nullptr); };
    if (!std::isnan(point.own)) json["own"] = number(point.own);
    if (!std::isnan(point.truth)) json["truth"] = number(point.truth);
    if (!point.why.empty()) json["why"] = point.why;
}

std::string axisOf(const CurveResults& results) {
    for (const StressCurve& curve : stressCurves())
        if (curve.name == results.curve) return std::string(curve.axis);
    return {};
}

// Whether the number that the curve is over should not change the picture.
bool staysSame(const CurveResults& results) {
    for (const StressCurve& curve : stressCurves())
        if (curve.name == results.curve) return curve.staysSame;
    return true;
}

std::string cell(double value) {
    if (std::isnan(value)) return "";
    return std::isinf(value) ? "none" : fmt::format("{:.3g}", value);
}

} // namespace

std::string curveJson(const CurveResults& results) {
    Out plots = Out::array();
    for (const CurvePlot& plot : results.plots) {
        Out all = Out::array();
        for (const CurveSeries& series : plot.series) {
            Out plain = Out::object(), points = Out::array();
            addPoint(plain, series.plain);
            for (const CurvePoint& point : series.points) {
                Out json = {{"value", point.value}};
                addPoint(json, point);
                points.push_back(std::move(json));
            }
            all.push_back({{"name", series.name},
                           {"command", series.command},
                           {"plain", std::move(plain)},
                           {"points", std::move(points)}});
        }
        plots.push_back({{"scene", plot.scene}, {"series", std::move(all)}});
    }
    const Out json = {
        {"kestrel_curve", 1},       {"case", results.curve},        {"axis", axisOf(results)},
        {"title", results.title},   {"file", results.file},         {"size", results.size},
        {"frames", results.frames}, {"renderer", results.renderer}, {"plots", std::move(plots)}};
    return json.dump(1, ' ', false, Out::error_handler_t::replace) + "\n";
}

std::string curveText(const CurveResults& results) {
    std::string text;
    for (const CurvePlot& plot : results.plots) {
        if (plot.series.empty()) continue;
        const auto table = [&](const char* title, double CurvePoint::*value) {
            text += fmt::format("{}: {}, over {}\n{:<10}", plot.scene, title, axisOf(results), "");
            for (const CurveSeries& series : plot.series) text += fmt::format("  {:>12.12}", series.name);
            const auto row = [&](const std::string& name, auto&& pointOf) {
                text += fmt::format("\n{:<10}", name);
                for (const CurveSeries& series : plot.series)
                    text += fmt::format("  {:>12}", cell(pointOf(series).*value));
            };
            if (!std::isnan(plot.series.front().plain.*value))
                row("plain", [](const CurveSeries& series) -> const CurvePoint& { return series.plain; });
            for (size_t i = 0; i < plot.series.front().points.size(); ++i)
                row(fmt::format("{:g}", plot.series.front().points[i].value),
                    [i](const CurveSeries& series) -> const CurvePoint& { return series.points.at(i); });
            text += "\n";
        };
        table(staysSame(results) ? "distance to the plain picture"
                                 : "distance to the picture of the triangles in opposite order",
              &CurvePoint::own);
        if (plot.hasTruth) table("distance to the reference", &CurvePoint::truth);
    }
    return text;
}

std::string curvePage(const CurveResults& results) {
    using page::htmlText;
    std::string does;
    for (const StressCurve& curve : stressCurves())
        if (curve.name == results.curve) does = curve.does;
    const std::string title = fmt::format("{}: {}", results.title, results.curve);
    std::string body = fmt::format("<div id=\"page\">\n<h1>{}</h1>\n<p>{}.</p>\n<div class=\"facts\">",
                                   htmlText(title), htmlText(does));
    for (const auto& [name, value] :
         {std::pair{"file", results.file}, std::pair{"size", results.size},
          std::pair{"frames", std::to_string(results.frames)}, std::pair{"renderer", results.renderer}})
        body += fmt::format("<span>{} <b>{}</b></span>", name, htmlText(value));
    body += fmt::format(
        "</div>\n<p class=\"soft\">Distances are root mean squares of the difference over that of the "
        "picture "
        "that each is held against: {}. A cross: no picture, or one with values that are no numbers.</p>\n",
        staysSame(results)
            ? "on the left the technique's own of the scene as it is (at 'plain' two seeds), on the right "
              "the "
              "reference's"
            : "on the left the technique's own of the triangles in opposite order, on the right the "
              "reference's");
    for (const CurvePlot& plot : results.plots) {
        body += fmt::format("<h2>{}</h2>\n<div class=\"card\">{}</div>\n", htmlText(plot.scene),
                            curveSvg(results, plot));
        for (const CurveSeries& series : plot.series) {
            for (const CurvePoint& point : series.points)
                if (!point.why.empty())
                    body += fmt::format("<p class=\"failed\">{} at {:g}: {}</p>\n", htmlText(series.name),
                                        point.value, htmlText(point.why));
            body += fmt::format("<div class=\"command\"><pre>{}</pre></div>\n", htmlText(series.command));
        }
    }
    return page::document(title, "", body + "</div>\n");
}

} // namespace kestrel
