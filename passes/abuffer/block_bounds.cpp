#include "block_bounds.h"
#include "views.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {

namespace {

// Invocations in rows, since an axis has 65,535 work groups at most.
constexpr std::uint64_t blockRow = 1 << 21;

std::uint64_t blocksOf(const FragmentLists& lists, const Extent& frame, int level) {
    const auto along = [level](std::uint64_t pixels) {
        return (pixels + (1u << (2 * level)) - 1) >> (2 * level);
    };
    const auto side = along(static_cast<std::uint64_t>(lists.side));
    return (lists.mainView ? along(frame.width) * along(frame.height) : 0) +
           shared::abufferFaces * side * side;
}

} // namespace

void declareBlockBounds(Declaration& declaration, const World& world, const FragmentLists& lists,
                        bool primitives, const std::vector<Use>& reads) {
    std::uint64_t blocks = 0;
    for (int level = 0; level < blockLevels; ++level) blocks += blocksOf(lists, world.size, level);
    if (2 * blocks > static_cast<std::uint64_t>(world.capabilities.maxTextureBufferTexels))
        declaration.problems.push_back(
            {"",
             fmt::format("'block_bounds' needs {} texels in a buffer texture; the limit is {}", 2 * blocks,
                         world.capabilities.maxTextureBufferTexels),
             true});
    declaration.outputs.push_back({.port = "block_bounds", .desc = Desc::buffer(8 * blocks, Format::R32UI)});
    for (int level = 0; level < blockLevels; ++level) {
        const std::uint64_t count = blocksOf(lists, world.size, level);
        Step step{.name = fmt::format("level_{}", level),
                  .run =
                      [count](Commands& commands) {
                          commands.dispatchOver(
                              static_cast<std::uint32_t>(std::min(count, blockRow)),
                              static_cast<std::uint32_t>((count + blockRow - 1) / blockRow));
                      },
                  .shaders = {"abuffer/blocks.comp"},
                  .defines = abufferDefines(lists, world.size),
                  .uses = {{.port = "block_bounds", .access = Access::Image, .write = true}},
                  .group = "levels"};
        step.defines.insert({{"LEVEL", std::to_string(level)}, {"ROW", std::to_string(blockRow)}});
        if (primitives) step.defines.emplace("PRIMITIVES", "1");
        if (level == 0) step.uses.insert(step.uses.end(), reads.begin(), reads.end());
        declaration.steps.push_back(std::move(step));
    }
}

} // namespace kestrel
