// The search that `kestrel tune` makes: coordinate-wise narrowing. Knows nothing of graphs and pictures: it
// asks for errors and whether a setting may take the time that it takes. After how XeGTAO's settings were
// found (Intel, "XeGTAO", 2021, "Auto-tune": each setting in ten steps, about the best of them again in finer
// ones).
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace kestrel {

// One free property: a range of numbers, both ends included, or one of several choices.
struct TuneAxis {
    double low = 0, high = 1; // low < high
    bool whole = false;       // whole numbers only
    bool logarithmic = false; // steps are equal ratios; low > 0
    int choices = 0;          // more than 0: the values are 0 to choices - 1, in no order
};

// A value of each axis. That of the start may lie outside of a range.
using TuneSetting = std::vector<double>;

struct TuneEffort {
    int steps = 10;      // values of a range in each round; at least 3
    int rounds = 3;      // each over narrower ranges
    int probes = 8;      // settings of the whole space that are tried first: the best one is narrowed about
    double gain = 0.001; // a setting is taken if its error is smaller by more than this share
    std::uint32_t seed = 0; // of the probes
};

struct TuneQuestions {
    // The error of a setting, at least 0. Whoever is sure that it is not below `bound` may give nothing.
    std::function<std::optional<double>(const TuneSetting&, double bound)> error;
    // Whether the setting's time is within the limit. Asked only of settings that would be taken: times are
    // dearer to measure than errors, and never quite the same.
    std::function<bool(const TuneSetting&)> affordable;
};

// A setting that was taken.
struct TuneStep {
    int round = 0; // 0: among the probes
    int axis = -1; // that it was found along; -1: a probe
    TuneSetting setting;
    double error = 0;
};

struct TuneFound {
    TuneSetting setting;
    double startError = 0, error = 0;
    std::vector<TuneStep> path; // each better than those before
    int asked = 0;              // settings whose error was asked for, the start among them
    int tooSlow = 0;            // of better error that would have taken too long
};

// The best setting that it finds; the start is one of them, whatever it takes, and the only one where it has
// no error (then `startError` is infinite). Answers alike, it does alike: no clock and no state of the
// machine has a part in it. Each axis in turn is tried at `steps` values (choices: at all), and the best
// affordable one taken. After each round a range shrinks to the neighbours of the value that was taken, or
// moves to it where it lay at the end.
TuneFound searchTuning(const std::vector<TuneAxis>& axes, const TuneSetting& start, const TuneEffort& effort,
                       const TuneQuestions& questions);

// The values at which a part of an axis is tried: `count` from `low` to `high`, rounded to a twentieth of a
// step or finer, so that they read well; whole ones each once.
std::vector<double> tuneValues(const TuneAxis& axis, double low, double high, int count);

} // namespace kestrel
