// What stress cases found: one record a case, as JSON, as lines for people and as a page.
#pragma once
#include "core/json.h"
#include "measure/stress/stress_case.h"
#include <filesystem>
#include <string>
#include <vector>

namespace kestrel {

// One thing that was expected of one port.
struct StressCheck {
    std::string port = {};    // "ao.visibility"
    std::string expects = {}; // stressExpectsName()
    bool held = true;
    // How far apart pictures were, over what is allowed (stress_distance.h); of "energy" the mean over what a
    // closed room may have; of "finite" how many values are bad. Infinite where pictures hold what is no
    // number.
    double missed = 0;
    int x = -1, y = -1;       // the first bad pixel, or where pictures differ most; -1: none
    std::string what = {};    // in words, with the pixel; empty if it held
    std::string picture = {}; // file below the page's folder; empty: none
    std::string limit = {};   // why it may be missed so far: a limit of the method (stress_limits.h)
    friend bool operator==(const StressCheck&, const StressCheck&) = default;
};

enum class StressOutcome : std::uint8_t {
    Held,
    Missed,  // a check was
    Crashed, // the process ended
    Hung,    // it took longer than the time limit
    Refused, // graph, scene or settings were, with a message
    Lacking, // the device lacks what it takes
    Unfit    // the graph says that what the case sets of its properties does not fit together
};
[[nodiscard]] std::string_view stressOutcomeName(StressOutcome outcome); // "held", "missed"…
// Whether it makes the run fail.
[[nodiscard]] bool isBad(StressOutcome outcome);

struct StressResult {
    std::string name = {}; // of the case
    StressOutcome outcome = StressOutcome::Held;
    std::string why = {};   // of a crash, a hang, a refusal
    std::string where = {}; // which step ran then: "pass 'a', step 'b'"
    double ms = 0;
    std::vector<StressCheck> checks = {}; // of every port that was looked at, "finite" first
    std::string command = {};             // that shows it
    friend bool operator==(const StressResult&, const StressResult&) = default;
};

// As one line of JSON, and back. Throws InputError where it is none.
[[nodiscard]] std::string stressResultText(const StressResult& result);
[[nodiscard]] StressResult stressResultOf(const Json& json);

// Of what was run: results of two runs belong together where all of it is equal.
struct StressRunInfo {
    std::string graph = {}, scene = {}, size = {};
    std::string hash = {}; // of graph, settings, scene and version
    std::string renderer = {};
    friend bool operator==(const StressRunInfo&, const StressRunInfo&) = default;
};

// {"kestrel_stress":1,"graph","scene","size","hash","renderer","cases":[{"name","kind","does","outcome","why",
// "where","ms","checks":[{"port","expects","held","missed","pixel","what","picture","limit"}],"command"}]};
// keys are only ever added.
[[nodiscard]] std::string stressJson(const StressRunInfo& info, const std::vector<StressResult>& results);
// The results of a file that stressJson() made. Throws InputError if it is none, or of another run.
[[nodiscard]] std::vector<StressResult> readStressResults(const std::filesystem::path& file,
                                                          const StressRunInfo& info);

// "missed  scale/1e-06: ao.visibility: …", a line each of what is worth telling; nothing of what held.
[[nodiscard]] std::string stressText(const StressResult& result);

// One page without outside links: cases by outputs, with pictures of what was missed.
[[nodiscard]] std::string stressPage(const StressRunInfo& info, const std::vector<StressResult>& results);

} // namespace kestrel
