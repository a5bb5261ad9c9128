#include "primitive_records.h"
#include "draw/material_defines.h"
#include "shared/work_list.h"
#include "views.h"
#include <algorithm>
#include <cstddef>
#include <fmt/format.h>

namespace kestrel {

namespace {

// Pixels whose records one invocation adds up: few enough for one invocation to add up the runs.
constexpr std::uint64_t pixelsPerSum = 128, maxSums = 60'000;
// Room at first, for each pixel; what is really wanted is told by the counters.
constexpr std::uint64_t recordsPerPixel = 4;
constexpr std::uint64_t listCapacity = 4096;
// Invocations in rows, since an axis has 65,535 work groups at most.
constexpr std::uint64_t recordRow = 1 << 21;
// A triangle whose box has more pixels is looked at in blocks.
constexpr int fewPixels = 64;

struct Sizes {
    std::uint64_t pixels, candidates, records, blocks, tiles, runs;
    int words; // of a pixel in `cells`
};

Sizes sizesOf(const World& world, const FragmentLists& lists, const Demand& demand) {
    Sizes sizes{};
    sizes.pixels = abufferPixels(lists, world.size);
    const std::uint64_t room = recordsPerPixel * sizes.pixels;
    sizes.candidates = std::max(demand.grown("candidates"), room);
    sizes.records = std::max(demand.grown("records"), room);
    sizes.blocks = std::max(demand.grown("blocks"), listCapacity);
    sizes.tiles = std::max(demand.grown("tiles"), 4 * listCapacity);
    sizes.runs = (sizes.pixels + pixelsPerSum - 1) / pixelsPerSum;
    sizes.words = lists.buckets + 3;
    return sizes;
}

// How many elements there is room for: uniforms, since programs would be made anew whenever a buffer grows.
void setRoom(Commands& commands, const std::string& port, std::uint64_t bytes) {
    commands.set(port + "_room", static_cast<std::uint32_t>(commands.desc(port).bytes / bytes));
}
void setListRoom(Commands& commands, const std::string& port) {
    commands.set(port + "_room", static_cast<std::uint32_t>(
                                     (commands.desc(port).bytes - sizeof(shared::WorkListHeader)) / 8));
}

// The steps share what they are compiled with.
class RecordSteps {
public:
    RecordSteps(const World& world, const FragmentLists& lists, const Sizes& sizes)
        : sizes_(sizes)
        , views_(static_cast<std::uint32_t>((lists.mainView ? 1 : 0) +
                                            (lists.side > 0 ? shared::abufferFaces : 0)))
        , defines_(materialDefines(world.facts)) {
        defines_.merge(abufferDefines(lists, world.size));
        defines_.insert({{"FIRST_VIEW", lists.mainView ? "0" : "1"},
                         {"ROW", std::to_string(recordRow)},
                         {"FEW", std::to_string(fewPixels)},
                         {"RUN", std::to_string(pixelsPerSum)},
                         {"RUNS", std::to_string(sizes.runs)},
                         {"PIXELS_IN_ALL", std::to_string(sizes.pixels)}});
    }

    [[nodiscard]] std::vector<Step> all() const {
        return {find(),
                listed("blocks", "tiles"),
                listed("tiles", ""),
                candidates("count", "COUNT"),
                cells("sum"),
                cells("scan"),
                cells("place"),
                candidates("scatter", "SCATTER"),
                candidates("rank", "RANK")};
    }

private:
    [[nodiscard]] static Use writes(const char* port, Access access = Access::Image) {
        return {.port = port, .access = access, .write = true};
    }
    [[nodiscard]] Step step(const char* name, const char* shader, std::vector<Use> uses) const {
        return {.name = name,
                .shaders = {shader},
                .defines = defines_,
                .uses = std::move(uses),
                .group = "records"};
    }

    // Every triangle in every view.
    [[nodiscard]] Step find() const {
        Step made = step("triangles", "abuffer/primitives.comp",
                         {writes("cells"), writes("candidates"), writes("candidate_count", Access::Storage),
                          writes("blocks", Access::Storage)});
        made.run = [views = views_](Commands& commands) {
            const std::uint32_t triangles = commands.geometry().triangleCount();
            commands.set("triangleCount", triangles);
            setRoom(commands, "candidates", 16);
            setListRoom(commands, "blocks");
            commands.dispatchOver(std::min<std::uint32_t>(triangles, recordRow),
                                  static_cast<std::uint32_t>((triangles + recordRow - 1) / recordRow), views);
        };
        return made;
    }
    // What lies in a list, which fills another or gives candidates.
    [[nodiscard]] Step listed(const char* list, const std::string& next) const {
        Step made = step(list, "abuffer/primitives.comp",
                         {{.port = list, .access = Access::Storage},
                          {.port = list, .access = Access::Indirect},
                          writes("cells"),
                          writes("candidate_count", Access::Storage)});
        if (next.empty()) {
            made.defines.emplace("TILES", "1");
            made.uses.push_back(writes("candidates"));
        } else {
            made.defines.emplace("BLOCKS", "1");
            made.uses.push_back(writes("tiles", Access::Storage));
        }
        made.run = [list = std::string(list), next](Commands& commands) {
            setListRoom(commands, list);
            if (next.empty())
                setRoom(commands, "candidates", 16);
            else
                setListRoom(commands, next);
            commands.dispatchIndirect(list, offsetof(shared::WorkListHeader, groups));
        };
        return made;
    }
    // Every candidate.
    [[nodiscard]] Step candidates(const char* name, const char* what) const {
        Step made = step(name, "abuffer/primitives.comp",
                         {{.port = "candidates", .access = Access::Image},
                          {.port = "candidate_count", .access = Access::Storage}});
        const std::string define = what;
        made.defines.emplace(define, "1");
        made.uses.push_back({.port = "cells", .access = Access::Image, .write = define != "RANK"});
        if (define != "COUNT")
            made.uses.push_back({.port = "order", .access = Access::Image, .write = define == "SCATTER"});
        if (define == "RANK") made.uses.push_back(writes("records"));
        made.run = [count = sizes_.candidates, define](Commands& commands) {
            setRoom(commands, "candidates", 16);
            if (define == "SCATTER") setRoom(commands, "order", 4);
            if (define == "RANK") setRoom(commands, "records", 16);
            commands.dispatchOver(static_cast<std::uint32_t>(std::min(count, recordRow)),
                                  static_cast<std::uint32_t>((count + recordRow - 1) / recordRow));
        };
        return made;
    }
    // Where the records of each pixel and bucket begin.
    [[nodiscard]] Step cells(const std::string& name) const {
        const bool scan = name == "scan";
        Step made = step(name.c_str(), "abuffer/primitive_cells.comp", {writes("record_runs")});
        made.defines.emplace(scan ? "SCAN" : (name == "sum" ? "SUM" : "PLACE"), "1");
        made.defines.emplace("LOCAL_SIZE", scan ? "1" : "8");
        made.uses.push_back(scan ? writes("record_count", Access::Storage) : writes("cells"));
        if (name == "place") made.uses.push_back(writes("longest_list", Access::Storage));
        made.run = [over = scan ? 1 : static_cast<std::uint32_t>(sizes_.runs)](Commands& commands) {
            commands.dispatchOver(over);
        };
        return made;
    }

    Sizes sizes_;
    std::uint32_t views_;
    Defines defines_;
};

} // namespace

std::vector<Use> declarePrimitiveRecords(Declaration& declaration, const World& world,
                                         const FragmentLists& lists, const Demand& demand) {
    const Sizes sizes = sizesOf(world, lists, demand);
    const auto limit = static_cast<std::uint64_t>(world.capabilities.maxTextureBufferTexels);
    const auto texels = [&](const char* port, std::uint64_t count, Format format) -> Output& {
        if (count > limit)
            declaration.problems.push_back(
                {"",
                 fmt::format("'{}' needs {} texels in a buffer texture; the limit is {}", port, count, limit),
                 true});
        Desc desc =
            Desc::buffer(std::max<std::uint64_t>(count, 1) * (format == Format::R32UI ? 4 : 16), format);
        desc.lists = lists;
        desc.extent = world.size; // the frame's view is told with every buffer
        declaration.outputs.push_back({.port = port, .desc = desc});
        return declaration.outputs.back();
    };
    const glm::vec4 none(0);
    // That there was too little room for what `port` holds is told by the first word of `counter`.
    const auto grows = [&](Output& output, const char* counter, std::uint64_t capacity) {
        output.counter = counter;
        output.capacity = capacity;
    };
    Output& cells = texels("cells", sizes.pixels * static_cast<std::uint64_t>(sizes.words), Format::R32UI);
    cells.clear = none;
    // No list may stay unordered: where one would the executor comes back with its length.
    grows(cells, "longest_list", longestRecordList);
    if (demand.grown("cells") > 0)
        declaration.problems.push_back({"",
                                        fmt::format("a pixel has {} records of primitives; the limit is {}",
                                                    demand.grown("cells"), longestRecordList),
                                        true});
    grows(texels("records", sizes.records, Format::RGBA32UI), "record_count", sizes.records);
    grows(texels("candidates", sizes.candidates, Format::RGBA32UI), "candidate_count", sizes.candidates);
    texels("order", sizes.records, Format::R32UI);
    texels("record_runs", sizes.runs, Format::R32UI);
    if (sizes.runs > maxSums)
        declaration.problems.push_back(
            {"", fmt::format("{} pixels in all views; the limit is {}", sizes.pixels, maxSums * pixelsPerSum),
             true});
    for (const char* counter : {"candidate_count", "record_count", "longest_list"})
        declaration.outputs.push_back({.port = counter, .desc = Desc::buffer(4), .clear = none});
    for (const auto& [list, capacity] : {std::pair{"blocks", sizes.blocks}, std::pair{"tiles", sizes.tiles}})
        declaration.outputs.push_back({.port = list,
                                       .desc = Desc::buffer(sizeof(shared::WorkListHeader) + 8 * capacity),
                                       .clear = none,
                                       .counter = list,
                                       .capacity = capacity});
    for (Step& step : RecordSteps(world, lists, sizes).all()) declaration.steps.push_back(std::move(step));
    return {{.port = "cells", .access = Access::Image}, {.port = "records", .access = Access::Image}};
}

} // namespace kestrel
