#include "abuffer_reorder.h"
#include "shared/work_list.h"
#include "views.h"
#include <algorithm>
#include <cstddef>
#include <fmt/format.h>

namespace kestrel {

PassType ABufferReorder::type() {
    return Describe<ABufferReorder>("ABufferReorder",
                                    "Sorts the lists of an A-buffer by depth and links them")
        .input("stored_pixels", PortKind::Buffer, "`pixels` of ABufferStore")
        .input("stored_nodes", PortKind::Buffer, "`nodes` of ABufferStore")
        .input("data", PortKind::Buffer, "The triangle of each node, where data is decoupled")
        .input("segments", PortKind::Buffer, "Where each pixel's nodes lie, if they lie side by side")
        .output("pixels", PortKind::Buffer, "What each pixel of each view knows of its list")
        .output("nodes", PortKind::Buffer, "The nodes, sorted and linked")
        .output("triangles", PortKind::Buffer,
                "`data`, where somebody reads it: fragments at one depth are in the order of their triangles "
                "then, and otherwise in that of their arrival, which nobody can tell")
        .internal("long_lists", PortKind::Buffer, "Lists that take steps of their own to sort")
        .internal("longest", PortKind::Buffer,
                  "Fragments of the longest list, if it is too long to be sorted");
}

Declaration ABufferReorder::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const Desc& stored = inputs["stored_nodes"].desc;
    const FragmentLists& lists = stored.lists;
    const bool bucketed = lists.buckets > 1 || lists.structure == FragmentLists::Structure::LLB ||
                          lists.structure == FragmentLists::Structure::DLLB;
    const std::uint64_t listed = abufferPixels(lists, world.size);
    const bool counted = listed > 0 && inputs["segments"].desc.bytes >= 8 * listed;
    Output pixels{.port = "pixels", .desc = inputs["stored_pixels"].desc, .updates = "stored_pixels"};
    if (counted) {
        const std::uint64_t words = listed * static_cast<std::uint64_t>(abufferPixelWords(lists));
        pixels.desc.bytes = 4 * words;
        pixels.updates.clear();
        pixels.clear = glm::vec4(0);
        if (static_cast<std::int64_t>(words) > world.capabilities.maxTextureBufferTexels)
            declaration.problems.push_back(
                {"pixels",
                 fmt::format("needs {} texels in a buffer texture; the limit is {}", words,
                             world.capabilities.maxTextureBufferTexels),
                 true});
    }
    declaration.outputs.push_back(std::move(pixels));
    declaration.outputs.push_back({.port = "nodes", .desc = stored, .updates = "stored_nodes"});
    // What nobody reads is not stored either.
    const bool triangles = demand.reads("triangles");
    if (triangles)
        declaration.outputs.push_back({.port = "triangles", .desc = inputs["data"].desc, .same = "data"});
    if (inputs["stored_nodes"].constant) {
        declaration.leftOut.push_back({"sorting", "there are no fragments"});
        for (Output& output : declaration.outputs) {
            if (output.same.empty()) output.same = output.updates;
            output.updates.clear();
        }
        return declaration;
    }
    const bool linked = lists.structure != FragmentLists::Structure::SB;
    const int longest = linked ? longestList : mediumList;
    // No list may stay unsorted: where one would the executor comes back with its length.
    declaration.outputs.push_back({.port = "longest", .desc = Desc::buffer(4), .clear = glm::vec4(0)});
    declaration.outputs.front().counter = "longest";
    declaration.outputs.front().capacity = static_cast<std::uint64_t>(longest);
    if (demand.grown("pixels") > 0)
        declaration.problems.push_back(
            {"stored_pixels",
             fmt::format("has a list of more than {} fragments, which is the most that is sorted{}", longest,
                         linked ? "" : " without links"),
             true});

    const std::uint64_t items =
        abufferPixels(lists, world.size) *
        (bucketed && !counted && !lists.shifted ? static_cast<std::uint64_t>(lists.buckets) : 1);
    // In rows, since an axis has 65,535 work groups at most.
    static constexpr std::uint64_t row = 1 << 21;
    Step sort{.name = "sort",
              .run =
                  [items](Commands& commands) {
                      commands.dispatchOver(static_cast<std::uint32_t>(std::min(items, row)),
                                            static_cast<std::uint32_t>((items + row - 1) / row));
                  },
              .shaders = {"abuffer/reorder.comp"},
              .defines = abufferDefines(lists, world.size),
              .uses = {{.port = "pixels", .access = Access::Image, .write = true},
                       {.port = "nodes", .access = Access::Image, .write = true},
                       {.port = "longest", .access = Access::Storage, .write = true}},
              .group = "reorder"};
    sort.defines.insert({{"ITEMS", std::to_string(items)},
                         {"ROW", std::to_string(row)},
                         {"SHORT", std::to_string(shortList)},
                         {"MEDIUM", std::to_string(mediumList)},
                         {"LONGEST", std::to_string(longest)}});
    if (!counted) sort.defines.emplace("COUNTER", "1");
    if (lists.decoupled && triangles) sort.uses.push_back({.port = "data", .access = Access::Image});
    if (lists.decoupled && !triangles) sort.defines.emplace("NO_TRIANGLES", "1");
    if (linked) {
        const std::uint64_t capacity = std::max<std::uint64_t>(demand.grown("long_lists"), 4096);
        declaration.outputs.push_back({.port = "long_lists",
                                       .desc = Desc::buffer(sizeof(shared::WorkListHeader) + 4 * capacity),
                                       .clear = glm::vec4(0),
                                       .counter = "long_lists",
                                       .capacity = capacity});
        sort.defines.emplace("LIST_CAPACITY", std::to_string(capacity));
        sort.uses.push_back({.port = "long_lists", .access = Access::Storage, .write = true});
    }
    Step longer = sort;
    if (counted) sort.uses.push_back({.port = "segments", .access = Access::Image});
    declaration.steps.push_back(std::move(sort));
    if (!linked) return declaration;

    longer.run = [](Commands& commands) {
        commands.dispatchIndirect("long_lists", offsetof(shared::WorkListHeader, groups));
    };
    longer.uses.push_back({.port = "long_lists", .access = Access::Indirect});
    for (int width = 1; width < longestList; width *= 2) {
        Step merge = longer;
        merge.name = fmt::format("merge_{}", width);
        merge.defines.emplace("MERGE", std::to_string(width));
        declaration.steps.push_back(std::move(merge));
    }
    longer.name = "link";
    longer.defines.emplace("LINK", "1");
    declaration.steps.push_back(std::move(longer));
    return declaration;
}

} // namespace kestrel
