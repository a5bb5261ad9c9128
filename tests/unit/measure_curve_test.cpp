// Curves of stress cases: their cases by name, and what was found as text and picture.
#include "core/json.h"
#include "measure/stress/curve.h"
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

namespace kestrel {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(StressCurves, HaveCasesThatTheirNamesTell) {
    std::set<std::string_view> names;
    for (const StressCurve& curve : stressCurves()) {
        EXPECT_TRUE(names.insert(curve.name).second);
        EXPECT_FALSE(curve.does.empty() || curve.does.ends_with('.') || curve.axis.empty());
        EXPECT_TRUE(std::ranges::is_sorted(curve.values) && curve.values.front() > 0);
        for (const double value : curve.values) {
            StressCase expected = curve.at(value);
            const auto found = curveCase(curveCaseName(curve, CurvePicture::At, value));
            ASSERT_TRUE(found) << curve.name << " " << value;
            EXPECT_EQ(found->edit, expected.edit);
            EXPECT_EQ(found->scene, expected.scene);
            expected.edit.triangles = SceneEdit::Triangles::Reversed;
            EXPECT_EQ(curveCase(curveCaseName(curve, CurvePicture::Reversed, value))->edit, expected.edit);
        }
        EXPECT_EQ(curveCase(curveCaseName(curve, CurvePicture::Plain, 0))->edit, SceneEdit{});
        EXPECT_EQ(curveCase(curveCaseName(curve, CurvePicture::Seed, 0))->seed, 1u);
    }
    for (const char* name : {"curve/", "curve/scale", "curve/scale/", "curve/scale/x", "curve/scael/1",
                             "curve/scale/1x", "scale/1", ""})
        EXPECT_FALSE(curveCase(name)) << name;
    EXPECT_THROW(static_cast<void>(stressCurve("scael")), InputError);
}

CurveResults exampleCurve() {
    CurveResults results{
        .curve = "scale", .title = "A & B", .file = "s.json", .size = "8x8", .renderer = "r"};
    CurveSeries first{
        .name = "one <1>", .command = "kestrel stress s.json", .plain = {.own = 0.25, .truth = 0.125}};
    first.points = {{.value = 1, .own = 0, .truth = 0.5},
                    {.value = 100, .own = INFINITY, .truth = INFINITY, .why = "the process ended"}};
    results.plots = {{.scene = "blob", .hasTruth = true, .series = {first}}};
    return results;
}

TEST(StressCurves, AsJson) {
    const Json json = Json::parse(curveJson(exampleCurve()), "curve");
    EXPECT_EQ(json.find("case")->text, "scale");
    EXPECT_EQ(json.find("axis")->text, stressCurve("scale").axis);
    const Json& series = json.find("plots")->items[0].find("series")->items[0];
    EXPECT_EQ(series.find("plain")->find("own")->number, 0.25);
    const Json& crash = series.find("points")->items[1];
    EXPECT_EQ(crash.find("own")->kind, Json::Kind::Null);
    EXPECT_EQ(crash.find("why")->text, "the process ended");
}

TEST(StressCurves, AsTable) {
    EXPECT_EQ(curveText(exampleCurve()), "blob: distance to the plain picture, over scale of the scene\n"
                                         "                 one <1>\n"
                                         "plain               0.25\n"
                                         "1                      0\n"
                                         "100                 none\n"
                                         "blob: distance to the reference, over scale of the scene\n"
                                         "                 one <1>\n"
                                         "plain              0.125\n"
                                         "1                    0.5\n"
                                         "100                 none\n");
    CurveResults layers = exampleCurve();
    layers.curve = "layers";
    EXPECT_THAT(curveText(layers),
                HasSubstr("blob: distance to the picture of the triangles in opposite order, over "
                          "surfaces behind a pixel\n"));
}

TEST(StressCurves, AsPicture) {
    const CurveResults results = exampleCurve();
    const std::string svg = curveSvg(results, results.plots[0]);
    EXPECT_THAT(svg, HasSubstr("one &lt;1&gt; at 1: 0.5"));
    EXPECT_THAT(svg, Not(HasSubstr("<1>")));
    EXPECT_THAT(svg, HasSubstr("off the reference"));
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
    CurveResults alone = results;
    alone.plots[0].hasTruth = false;
    EXPECT_THAT(curveSvg(alone, alone.plots[0]), Not(HasSubstr("off the reference")));
    const std::string page = curvePage(results);
    EXPECT_THAT(page, HasSubstr("<h1>A &amp; B: scale</h1>"));
    EXPECT_THAT(page, HasSubstr("one &lt;1&gt; at 100: the process ended"));
}

} // namespace
} // namespace kestrel
