// What a sweep has measured: as parts (one file a measurement, so that a stopped sweep goes on), as rows, and
// as results.json, results.csv, results.md and a page.
#pragma once
#include "image/error_split.h"
#include "measure/sweep_file.h"
#include "measure/tune/tune_report.h"
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

// Median and quartiles of a series, linear between its sorted values (the median of an even count is the mean
// of the middle two). All 0 for an empty series.
struct Quartiles {
    double q1 = 0, median = 0, q3 = 0;
    friend bool operator==(const Quartiles&, const Quartiles&) = default;
};
Quartiles quartilesOf(std::vector<double> series);

// Which machine measured: times compare within one only.
struct SweepMachine {
    // Of this host, renderer and driver: "m" and 6 hexadecimal digits. It begins with a letter, so that
    // nothing that reads a table takes "012345" or "925e13" for a number.
    std::string id;
    std::string cpu, renderer, driver, clock, version;
    int threads = 0;
    std::string date; // of its last run: "2026-01-31", UTC
    friend bool operator==(const SweepMachine&, const SweepMachine&) = default;
};
SweepMachine thisMachine(const std::string& renderer, const std::string& driver, const std::string& clock);

// ---- parts

// One timed frame.
struct SweepFrame {
    struct Step {
        std::string pass, step, group;
        double ms = 0;
    };
    double ms = 0; // wall clock of the whole frame, the scene's update included
    std::vector<Step> steps;
};

// One repetition of one point on one scene.
struct SweepRepetition {
    int round = 0;
    std::string machine;
    double spinOne = 0, spinTwo = 0; // the spin test before this round, milliseconds
    std::vector<SweepFrame> frames;
};

struct SweepErrors {
    double mse = 0, ssim = 0, flip = 0;
    std::optional<double> psnr; // none for equal images
    friend bool operator==(const SweepErrors&, const SweepErrors&) = default;
};

struct SweepRayFigures {
    double rays = 0;      // that exist
    double hitShare = 0;  // of them that hit
    double agreement = 0; // share of rays that hit or miss as the reference's do
    std::optional<double>
        distanceError; // mean |t - reference| / reference where both hit; of closest hits only
    friend bool operator==(const SweepRayFigures&, const SweepRayFigures&) = default;
};

// Everything of one point on one scene but its times: measured once.
struct SweepPicture {
    std::string failed; // why there is nothing; empty: all is there
    std::string machine;
    std::optional<SweepErrors> errors;
    std::optional<SweepRayFigures> rays;
    std::optional<ErrorSplit> split; // of points that can trace their proxy exactly
    double compileMs = 0;            // of the graph, without shaders
    double setUpMs = 0;              // shaders, resources, the scene's upload and the first frame
    std::uint64_t transient = 0, unshared = 0, persistent = 0; // bytes
    std::vector<LeftOut> leftOut;
    std::map<std::string, double> reports; // "pass.key" of the last frame
    std::string picture, heatMap;          // file names relative to the folder of the results; may be empty
};

// The reference of a scene.
struct SweepReferenceRecord {
    std::optional<double> noise; // as its pass reports it
    double exposure = 1;         // that pictures of light are shown with
    std::string picture;
    std::map<std::string, double> reports;
    double hitShare = 0, rays = 0; // of the reference's hits, where there are ray variants
    std::string raysHash;
    bool nothingCounts = false; // its mask is 0 everywhere: pictures of the scene have times but no errors
};

std::string partText(const SweepRepetition& repetition);
std::string partText(const SweepPicture& picture);
std::string partText(const SweepReferenceRecord& record);
std::string partText(const SweepMachine& machine);
// Throw InputError naming `file` for what is no such part.
SweepRepetition repetitionOf(const std::string& text, const std::string& file);
SweepPicture pictureOf(const std::string& text, const std::string& file);
SweepReferenceRecord referenceRecordOf(const std::string& text, const std::string& file);
SweepMachine machineOf(const std::string& text, const std::string& file);

// ---- rows

struct SweepRow {
    std::string scene, camera, point, variant, series, along, plot;
    std::vector<std::pair<std::string, std::string>> axes;
    std::string tunedOf; // the point that this one is, tuned; empty: as the file has it
    bool ray = false;
    std::string machine; // that timed it
    int repeats = 0;     // timed frames
    // "total" (all steps), "frame", every group, and the times that the sweep names.
    std::map<std::string, Quartiles> ms;
    std::vector<std::pair<std::string, Quartiles>> steps; // "pass.step", in order of execution
    SweepPicture picture;
    std::optional<double> referenceNoise;
    bool pareto = false;               // on the front of its plot and machine, in the sweep's own axes
    std::string command, timesCommand; // make the picture again; measure the times again
};

// The times of a point over all its repetitions. Repetitions of several machines never mix: those of the
// machine with the most count.
void addTimes(SweepRow& row, const Sweep& sweep, const std::vector<SweepRepetition>& repetitions);

// Indices of the points that no other point beats: none is as good in both and better in one. In the order of
// rising time. Points that are not finite are not on it.
std::vector<size_t> paretoFront(const std::vector<std::pair<double, double>>& timeAndError);

// What the sweep's plots show as error: disagreement for rays. Nothing if it was not measured.
std::optional<double> errorOf(const SweepRow& row, const std::string& error);

// Sets SweepRow::pareto, plot by plot and machine by machine.
void markPareto(std::vector<SweepRow>& rows, const Sweep& sweep);

struct SweepResults {
    std::string hash; // of all that the measurements rest on
    std::vector<SweepMachine> machines;
    std::map<std::string, std::vector<std::pair<double, double>>>
        spins;                                              // machine -> spin tests (1, 2 threads)
    std::map<std::string, SweepReferenceRecord> references; // by scene
    std::vector<SweepRow> rows;
    std::optional<TuneReport> tuning;
    std::vector<std::string> missing; // "scene: point" that this folder does not hold
};

// Keys are only ever added; see the design: {"rows":[{"scene","variant","repeat_count","ms":{…},"memory",
// "mse","psnr","ssim","flip","reference_noise","command",…}],…}. Medians in "ms", quartiles in "ms_q1",
// "ms_q3".
std::string resultsJson(const Sweep& sweep, const SweepResults& results);
// One line a row, with a header; RFC 4180.
std::string resultsCsv(const Sweep& sweep, const SweepResults& results);
// The page: everything in one file but the pictures, which it names relative to itself.
std::string resultsPage(const Sweep& sweep, const SweepResults& results);

// Titles and tables of a results.json as Markdown: the command, date, machines and spin tests, and for each
// scene and plot its variants with times and errors. Throws InputError naming `file` for text that is no such
// document.
std::string resultsMarkdown(const std::string& json, const std::string& file);

// The command that makes a point's picture again, and the one that measures its times again. Files are
// absolute, so that both run from wherever the reader stands; what they make lands there.
std::string renderCommand(const Sweep& sweep, const SweepScene& scene, const SweepPoint& point);
std::string timesCommand(const Sweep& sweep, const SweepPoint& point);
// The command of the whole sweep. One that comes with Kestrel is named as from the root of its tree
// ("graphs/sweeps/snap.json"), another as it was named.
std::string sweepCommand(const Sweep& sweep);
// A word as a shell takes it.
std::string shellWord(const std::string& word);

// ---- folders

class SweepManifest;

// The files of a sweep's results under one folder.
class SweepFolder {
public:
    SweepFolder(std::filesystem::path folder, const Sweep& sweep);

    // Makes the folder ready. A folder that holds results is refused unless `resume`. Variants, values and
    // scenes that the sweep has gained join it; where something that is measured would come out otherwise, it
    // is refused with every cause; and, with `machine`, where another machine measured. Throws InputError.
    void begin(bool resume, const SweepMachine* machine) const;

    [[nodiscard]] std::optional<SweepReferenceRecord> reference(const SweepScene& scene) const;
    [[nodiscard]] std::optional<SweepPicture> picture(const SweepUnit& unit, const SweepPoint& point) const;
    [[nodiscard]] std::vector<SweepRepetition> repetitions(const SweepUnit& unit,
                                                           const SweepPoint& point) const;
    [[nodiscard]] bool hasTurn(const SweepUnit& unit, const SweepPoint& point, int round) const;
    void write(const SweepScene& scene, const SweepReferenceRecord& record) const;
    void write(const SweepUnit& unit, const SweepPoint& point, const SweepPicture& picture) const;
    void write(const SweepUnit& unit, const SweepPoint& point, const SweepRepetition& repetition) const;
    void write(const SweepMachine& machine) const;

    // Takes every part and picture of another folder of the same sweep. Throws InputError if that was
    // measured otherwise, with every cause, or holds what is here already.
    void merge(const SweepFolder& other) const;

    // What it holds, as rows in the order of the sweep.
    [[nodiscard]] SweepResults gather(const std::vector<SweepPoint>& points,
                                      const std::vector<SweepUnit>& units) const;
    // results.json, results.csv, results.md, index.html.
    void writeResults(const SweepResults& results) const;

    [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
    // Relative to path().
    [[nodiscard]] std::string pictureName(const SweepUnit& unit, const SweepPoint& point) const;
    [[nodiscard]] std::string heatMapName(const SweepUnit& unit, const SweepPoint& point) const;
    [[nodiscard]] std::string referenceName(const SweepScene& scene, const std::string& ending) const;

private:
    // Throws InputError with every cause why what was measured under `held` cannot stand beside `now`.
    void refuseChanges(const SweepManifest& held, const SweepManifest& now) const;
    [[nodiscard]] std::filesystem::path pointFolder(const SweepUnit& unit, const SweepPoint& point) const;
    std::filesystem::path folder_;
    const Sweep& sweep_;
};

} // namespace kestrel
