// What the measurements in a folder rest on, so that no two that were made otherwise ever stand in one table.
#pragma once
#include "measure/sweep_file.h"
#include <nlohmann/json.hpp>

namespace kestrel {

// What is free and how it is tuned counts where `kestrel tune` runs it. Graphs, scenes and the files that
// either names (buffers, images, paths of cameras, pictures of the surroundings) count by their content,
// wherever they lie; what only names or shows a result (titles, times, series) and how often it is repeated
// do not count.
class SweepManifest {
public:
    // Of a sweep as it is. The content of a scene whose file is not here is not known.
    SweepManifest(const Sweep& sweep, std::string machine);
    // As it lies in a folder of results; nothing if there is none. Throws InputError for one that is
    // damaged, or of another format.
    static std::optional<SweepManifest> read(const std::filesystem::path& folder);
    void write(const std::filesystem::path& folder) const;

    // Every cause why measurements under this one are not those that `now` asks for, in words; none if all
    // can be kept. What only one of both has is no cause.
    [[nodiscard]] std::vector<std::string> changes(const SweepManifest& now) const;
    // Takes what only the other has.
    void add(const SweepManifest& other);

    [[nodiscard]] const std::string& machine() const { return machine_; } // or "several"
    [[nodiscard]] std::string hash() const; // 16 hexadecimal digits; of all but the machine

private:
    SweepManifest() = default;
    void addTuning(const Sweep& sweep, const std::vector<SweepPoint>& points);
    std::string machine_;
    nlohmann::json facts_; // kind -> what -> key -> value
};

} // namespace kestrel
