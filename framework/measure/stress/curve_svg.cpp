// A curve as a picture: it stands by itself, so it brings its colours along.
#include "measure/page_html.h"
#include "measure/stress/curve.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {
namespace {

// Of the pages' light set (page_style.cpp); after eight the lines are dashed.
constexpr std::array<const char*, 8> colours = {"#0072b2", "#c8500a", "#00835f", "#a83279",
                                                "#8a6d00", "#5b52c4", "#b3261e", "#3f6f7d"};
constexpr double width = 480, height = 340, left = 58, right = 14, top = 34, bottom = 48, plainGap = 40;

// What one panel shows of a point.
struct Panel {
    std::string title;
    double CurvePoint::*value;
};

class PanelSvg {
public:
    PanelSvg(const CurvePlot& plot, const Panel& panel, double x0, std::string axis)
        : plot_(plot)
        , value_(panel.value)
        , x0_(x0)
        , axis_(std::move(axis)) {
        title_ = panel.title;
        std::vector<double> finite, numbers;
        const auto note = [&](double value) {
            if (std::isfinite(value) && value > 0) finite.push_back(value);
        };
        for (const CurveSeries& series : plot.series) {
            hasPlain_ |= !std::isnan(series.plain.*value_);
            note(series.plain.*value_);
            for (const CurvePoint& point : series.points) {
                note(point.*value_);
                numbers.push_back(point.value);
            }
        }
        if (finite.empty()) finite = {1e-3, 1};
        yLow_ = std::floor(std::log10(std::max(std::ranges::min(finite), 1e-8)));
        yHigh_ = std::max(yLow_ + 1, std::ceil(std::log10(std::ranges::max(finite))));
        if (numbers.empty()) numbers = {1};
        xLow_ = std::log10(std::ranges::min(numbers));
        xHigh_ = std::max(xLow_ + 1, std::log10(std::ranges::max(numbers)));
    }

    std::string draw() {
        axes();
        for (size_t i = 0; i < plot_.series.size(); ++i) line(plot_.series[i], i);
        return std::move(svg_);
    }

private:
    [[nodiscard]] double x(double value) const {
        const double begin = x0_ + left + 10 + (hasPlain_ ? plainGap : 0), end = x0_ + width - right - 10;
        return begin + (std::log10(value) - xLow_) / (xHigh_ - xLow_) * (end - begin);
    }
    [[nodiscard]] double plainX() const { return x0_ + left + 14; }
    // Nothing at all lies on the lower edge, what is no picture on the upper one.
    [[nodiscard]] double y(double value) const {
        const double low = height - bottom - 16, high = top + 16;
        if (value == 0) return height - bottom;
        if (!std::isfinite(value)) return top;
        return low - (std::max(std::log10(value), yLow_) - yLow_) / (yHigh_ - yLow_) * (low - high);
    }

    void text(double at, double down, const char* anchor, const std::string& what, const char* more = "") {
        svg_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>", at, down,
                            anchor, more, page::htmlText(what));
    }
    void gridLine(double x1, double y1, double x2, double y2) {
        svg_ += fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"#e4e7ea\"/>", x1, y1, x2, y2);
    }

    void axes() {
        const double bottomY = height - bottom, endX = x0_ + width - right;
        for (int e = static_cast<int>(yLow_); e <= static_cast<int>(yHigh_); ++e) {
            const double at = y(std::pow(10.0, e));
            gridLine(x0_ + left, at, endX, at);
            text(x0_ + left - 6, at + 4, "end", fmt::format("{:g}", std::pow(10.0, e)));
        }
        text(x0_ + left - 6, bottomY + 4, "end", "0");
        const int first = static_cast<int>(std::ceil(xLow_ - 1e-9)), last = static_cast<int>(xHigh_ + 1e-9);
        const int every = last - first > 12 ? 3 : last - first > 5 ? 2 : 1;
        for (int e = first; e <= last; ++e) {
            const double at = x(std::pow(10.0, e));
            gridLine(at, top, at, bottomY);
            if ((e - first) % every == 0)
                text(at, bottomY + 17, "middle",
                     std::abs(e) <= 3 ? fmt::format("{:g}", std::pow(10.0, e)) : fmt::format("1e{}", e));
        }
        if (hasPlain_) {
            gridLine(plainX(), top, plainX(), bottomY);
            text(plainX(), bottomY + 17, "middle", "plain");
        }
        svg_ +=
            fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
                        "stroke=\"#c4c9cf\"/>",
                        x0_ + left, top, width - left - right, height - top - bottom);
        text((x0_ + left + endX) / 2, top - 12, "middle", title_, " class=\"h\"");
        text((x0_ + left + endX) / 2, height - 8, "middle", axis_);
    }

    void line(const CurveSeries& series, size_t index) {
        const char* colour = colours[index % colours.size()];
        std::string path, marks;
        bool begun = false;
        for (const CurvePoint& point : series.points) {
            const double value = point.*value_;
            if (std::isnan(value)) continue;
            path += fmt::format("{}{:.1f} {:.1f}", begun ? "L" : "M", x(point.value), y(value));
            begun = true;
            marks += mark(x(point.value), value, colour,
                          fmt::format("{} at {:g}: {:.3g}", series.name, point.value, value));
        }
        if (const double value = series.plain.*value_; !std::isnan(value))
            marks += mark(plainX(), value, colour, fmt::format("{}, plain: {:.3g}", series.name, value));
        svg_ += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"{}/>", path,
                            colour, index < colours.size() ? "" : " stroke-dasharray=\"5 3\"");
        svg_ += marks;
    }

    [[nodiscard]] std::string mark(double at, double value, const char* colour,
                                   const std::string& tip) const {
        const std::string title = "<title>" + page::htmlText(tip) + "</title>";
        const double down = y(value);
        if (!std::isfinite(value))
            return fmt::format("<path d=\"M{0:.1f} {1:.1f}l8 8m0 -8l-8 8\" stroke=\"{2}\" "
                               "stroke-width=\"2\">{3}</path>",
                               at - 4, down - 4, colour, title);
        return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\">{}</circle>", at, down,
                           colour, title);
    }

    const CurvePlot& plot_;
    double CurvePoint::*value_;
    double x0_;
    std::string axis_, title_, svg_;
    bool hasPlain_ = false;
    double xLow_ = 0, xHigh_ = 1, yLow_ = 0, yHigh_ = 1;
};

} // namespace

std::string curveSvg(const CurveResults& results, const CurvePlot& plot) {
    std::string axis;
    bool same = true;
    for (const StressCurve& curve : stressCurves())
        if (curve.name == results.curve) {
            axis = curve.axis;
            same = curve.staysSame;
        }
    std::vector<Panel> panels = {
        {same ? "off its own plain picture" : "off its own, triangles in opposite order", &CurvePoint::own}};
    if (plot.hasTruth) panels.push_back({"off the reference", &CurvePoint::truth});
    const double all = width * static_cast<double>(panels.size());
    std::string body;
    for (size_t i = 0; i < panels.size(); ++i)
        body += PanelSvg(plot, panels[i], width * static_cast<double>(i), axis).draw() + "\n";
    // The names below, as many in a row as fit.
    double at = left, down = height + 14;
    for (size_t i = 0; i < plot.series.size(); ++i) {
        const std::string& name = plot.series[i].name;
        const double needs = 30 + 7.2 * static_cast<double>(name.size());
        if (at + needs > all - right && at > left) {
            at = left;
            down += 18;
        }
        body +=
            fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\" fill=\"{}\"/><text x=\"{:.1f}\" "
                        "y=\"{:.1f}\" class=\"h\">{}</text>",
                        at + 5, down - 4, colours[i % colours.size()], at + 14, down, page::htmlText(name));
        at += needs;
    }
    return fmt::format(
        R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0:.0f} {1:.0f}" width="{0:.0f}">
<style>text {{ font: 12px system-ui, sans-serif; fill: #5d636b; }} text.h {{ fill: #1c1e21; }}</style>
<rect width="100%" height="100%" fill="#ffffff"/>
{2}</svg>
)",
        all, down + 10, body);
}

} // namespace kestrel
