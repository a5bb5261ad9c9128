// A sweep file: which variants of which graphs are measured on which scenes, against what. Plain data, no GL.
#pragma once
#include "graph/graph.h"
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace kestrel {

// Bounds on what a file may ask for.
inline constexpr size_t maxSweepPoints = 10'000; // also of variants and of an axis's values
inline constexpr size_t maxSweepTried = 100'000; // combinations of axes, those that are excluded too
inline constexpr size_t maxSweepScenes = 1'000, maxSweepAxes = 64, maxSweepExclusions = 1'000,
                        maxSweepSettings = 1'000, maxSweepTimes = 1'000, maxSweepFree = 64;
inline constexpr size_t maxSweepName = 200;               // bytes: names become keys, labels and file names
inline constexpr size_t maxSweepSetting = 1'000;          // bytes of one setting
inline constexpr size_t maxSweepText = size_t{256} << 20; // bytes of all points' settings and names
inline constexpr int maxSweepFrames = 100'000, maxSweepRepeats = 10'000, maxSweepSide = 16'384,
                     maxSweepSeed = 1 << 30;

// The errors that a page can show first.
const std::vector<std::string>& sweepErrors();

// One of the settings that `--set` takes, and where it stands.
struct SweepSetting {
    std::string text;
    Location where;
};

struct SweepScene {
    std::string name;   // of plots and file names: the file's, else the source's without "builtin:"
    std::string source; // "builtin:NAME", or a file: absolute, or relative to the folder of the sweep file
    SceneSetup setup;
    std::string slug; // unique, for file names
    Location where;
};
// The camera's name; of one that the sweep adds its keys; empty: the graph's, else the scene's first.
std::string cameraOf(const SweepScene& scene);

// What pictures are held against: run once a scene.
struct SweepReference {
    std::string graph;
    PortRef output;
    std::optional<PortRef> mask; // pixels count where it is greater than 0.5
    std::vector<SweepSetting> settings;
    int frames = 1;
    Location where;
};

// What RayQuery's hits are held against. All variants trace its rays, byte for byte.
struct SweepRays {
    std::string graph;
    PortRef rays, hits;
    std::vector<SweepSetting> settings;
    int frames = 1; // the rays of the last of them count, also for variants
    Location where;
};

struct SweepAxisValue {
    std::string label; // "128", "ROMA"
    std::vector<SweepSetting> settings;
};

struct SweepAxis {
    std::string name;
    std::vector<SweepAxisValue> values;
};

// A property that `kestrel tune` may set: to any number of a range, or to one of several values.
struct SweepFree {
    std::string name;                  // "pass.property"
    double low = 0, high = 0;          // of a range, both included
    bool logarithmic = false;          // steps of the range are equal ratios
    std::vector<SweepSetting> choices; // texts of values; empty: a range
    Location where;
};

struct SweepVariant {
    std::string name, graph, comment;
    bool ray = false; // `output` is a buffer of hits (RayQuery), else a picture
    PortRef output;
    std::vector<SweepSetting> settings;
    std::vector<SweepAxis> axes;                             // they multiply
    std::vector<std::map<std::string, std::string>> exclude; // axis -> label; all must agree
    std::vector<SweepFree> free;                             // what `kestrel tune` finds the best values of
    // Settings under which the graph traces the same map or field exactly, after all others: the error is
    // then taken apart (image/error_split.h).
    std::vector<SweepSetting> exact;
    std::string series; // points of one series are joined; "{axis}" stands for the axis's label
    std::string along;  // the axis along which they are joined
    std::string plot;   // which plot of the scene; empty: the only one
    std::optional<int> frames;
    Location where;
};

// A time that is made of others: the sum of groups ("generation") and passes ("roma"), some subtracted.
struct SweepTime {
    struct Term {
        std::string name; // a group or a pass; of neither: 0
        double factor = 1;
    };
    std::string name;
    std::vector<Term> terms;
};

// How `kestrel tune` finds the best values of free properties, and on which scenes.
struct SweepTuning {
    std::vector<std::string> train;   // names of scenes: the mean error over these is made small
    std::vector<std::string> holdOut; // that take no part in it, so that default and tuned are judged fairly
    int steps = 10, rounds = 3, probes = 8; // see TuneEffort
    // The time (the plot's, summed over the training scenes) of what is found is at most so many times that
    // of the default; with `mostMs` its mean over the training scenes is at most that instead.
    double mostTime = 1.05;
    std::optional<double> mostMs;
};

struct Sweep {
    std::string name, title, comment; // name: the file's without its ending
    std::filesystem::path file;
    bool sizeGiven = false, framesGiven = false; // on the command line, instead of the file's
    bool allowOutside = false; // SceneOptions::allowOutside, for all scenes; the command line's
    bool tuned = false;        // `kestrel tune` runs it: the results rest on `tuning` and what is free, too
    Extent size{640, 360, 1};
    int frames = 16;     // after which the picture is taken
    int warmUp = 1;      // frames that are not timed, each time a variant is timed
    int repeats = 5;     // repetitions of each variant, round-robin
    int timedFrames = 1; // a repetition
    std::uint32_t seed = 0;
    bool moving = false;  // scenes move on from frame to frame; else their time stands still at 0
    bool rebuild = false; // everything is made anew in each timed frame, as in a scene that moves
    bool hdr = false;     // pictures hold linear light without upper limit: HDR-FLIP
    std::string plotTime = "total", plotError = "flip"; // the axes that the page shows first
    std::vector<SweepTime> times;
    std::vector<SweepScene> scenes;
    std::optional<SweepReference> reference;
    std::optional<SweepRays> rays;
    std::optional<SweepTuning> tuning;
    std::vector<SweepVariant> variants;
};

// Reads the JSON form ("kestrel_sweep": 1). Throws InputError with every mistake (unknown keys, wrong kinds,
// unknown axes in labels and exclusions, names used twice), each with file:line:column and near names.
Sweep parseSweep(std::string_view text, const std::string& file);
Sweep loadSweep(const std::filesystem::path& file);

// One variant with one value of each of its axes.
struct SweepPoint {
    std::string name;    // unique: "roma, resolution 128, angular 4"
    std::string variant; // as in the file
    std::string series, along, plot;
    std::string slug; // unique, for file names: [a-z0-9_.-]
    std::string graph;
    bool ray = false;
    PortRef output;
    std::vector<SweepSetting> settings;                    // the variant's, then each axis's
    std::vector<std::pair<std::string, std::string>> axes; // name, label
    std::vector<SweepFree> free;
    std::vector<SweepSetting> exact;
    std::string tunedOf; // the point that this one is, tuned; empty: as the file has it
    int frames = 1;
    Location where;
};

// The name as any file system takes it ([a-z0-9_.-]), made unique among `taken`, which it joins.
std::string sweepSlug(const std::string& name, std::set<std::string>& taken);

// The point with its settings for exact tracing.
SweepPoint exactOf(const SweepPoint& point);

// In the order of the file; the last axis changes fastest. Throws InputError where a sweep has more than
// maxSweepPoints, maxSweepTried or maxSweepText, or where two points would have one name.
std::vector<SweepPoint> expandSweep(const Sweep& sweep);

// What is measured together, so that its times compare: one scene with all points of one plot.
struct SweepUnit {
    int scene = 0;
    std::string plot;
    std::vector<int> points; // indices into expandSweep's
    std::string slug;
};
std::vector<SweepUnit> sweepUnits(const Sweep& sweep, const std::vector<SweepPoint>& points);

// "I/N", 1 <= I <= N. Throws InputError for anything else. Of `count` units shard I of N has those whose
// index is I - 1 modulo N: each is in exactly one.
struct Shard {
    int index = 1, count = 1;
    [[nodiscard]] bool has(size_t unit) const {
        return unit % static_cast<size_t>(count) == static_cast<size_t>(index - 1);
    }
};
Shard parseShard(const std::string& text);

// The points whose name, variant or series is `only`; all if it is empty. Throws InputError with the near
// name if there is none.
std::vector<bool> choosePoints(const std::vector<SweepPoint>& points, const std::string& only);

// The graph file that a sweep names: absolute, or relative to the folder of the sweep file, else among the
// shipped graphs (shareFolder()/graphs). Throws InputError with the near name if there is none.
std::filesystem::path sweepGraphFile(const Sweep& sweep, const std::string& graph);

// The graph with the settings, with `outputs` as its only outputs. Throws InputError with everything that is
// wrong with it, at the places of the sweep file where these are known.
Graph sweepGraph(const Sweep& sweep, const std::string& graph, const std::vector<SweepSetting>& settings,
                 const std::vector<PortRef>& outputs, const Registry& registry, const Location& where);

// The file of a scene that is not built in, as it is named from where the program runs.
std::filesystem::path sweepSceneFile(const Sweep& sweep, const SweepScene& scene);

// Everything that is wrong with the graphs, settings and outputs of a sweep, before anything is measured.
// Throws InputError.
void checkSweep(const Sweep& sweep, const std::vector<SweepPoint>& points, const Registry& registry);
// The same of its scenes: files that are not there.
void checkSweepScenes(const Sweep& sweep);

} // namespace kestrel
