// Sweep files, and what they unfold to.
#include "fuzz.h"
#include "measure/sweep_file.h"
#include <set>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace kestrel;
    fuzz::taken([&] {
        const Sweep sweep = parseSweep(fuzz::textOf(data, size), "sweep.json");
        const std::vector<SweepPoint> points = expandSweep(sweep);
        KESTREL_CHECK_LE(points.size(), maxSweepPoints);
        std::set<std::string> slugs;
        for (const SweepPoint& point : points) {
            KESTREL_CHECK(slugs.insert(point.slug).second);
            KESTREL_CHECK(point.slug.find('/') == std::string::npos && point.slug.front() != '.');
        }
        std::size_t measured = 0;
        for (const SweepUnit& unit : sweepUnits(sweep, points)) measured += unit.points.size();
        KESTREL_CHECK_EQ(measured, points.size() * sweep.scenes.size());
        choosePoints(points, sweep.comment);
    });
    return 0;
}
