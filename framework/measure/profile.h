// Times of a run by pass and by group, and what a run is reported as.
#pragma once
#include "execute/renderer.h"
#include <map>
#include <string>
#include <vector>

namespace kestrel {

// Of a series of times, in milliseconds. All zero if the series is empty.
struct Spread {
    double median = 0, min = 0, max = 0;
    friend bool operator==(const Spread&, const Spread&) = default;
};

// The median of an even count is the mean of the middle two.
Spread spreadOf(std::vector<double> series);

// Collects the frames of a run.
class Profile {
public:
    void add(const FrameRecord& frame);

    struct PassTime {
        std::string name, type;
        int runs = 0; // frames in which it ran
        Spread ms;    // over those frames, all steps together
    };
    // In the order of execution. Passes that a plan has but that never ran are not listed.
    [[nodiscard]] std::vector<PassTime> passes() const;
    // What a frame costs by what its steps count as ("generation", "tracing", …), over all frames; a frame in
    // which nothing of a group ran counts as zero.
    [[nodiscard]] std::map<std::string, Spread> groups() const;
    // The wall clock of a frame, less what ran for previews alone.
    [[nodiscard]] Spread frame() const { return spreadOf(frames_); }
    // What ran for previews alone, a frame; all zero if nothing did.
    [[nodiscard]] Spread previews() const { return spreadOf(previews_); }
    [[nodiscard]] int frameCount() const { return static_cast<int>(frames_.size()); }

private:
    struct PassSeries {
        std::string name, type;
        std::vector<double> ms;
    };
    std::vector<PassSeries> passes_;
    std::map<std::string, std::map<size_t, double>> groups_; // group -> frame -> ms
    std::vector<double> frames_, previews_;
};

} // namespace kestrel
