#include "abuffer_store.h"
#include <algorithm>
#include <fmt/format.h>
#include <string_view>

namespace kestrel {

namespace {

using Structure = FragmentLists::Structure;

// Pixels whose fragments one invocation adds up: few enough for one invocation to add up the runs.
constexpr std::uint64_t pixelsPerRun = 256;
constexpr std::uint64_t maxRuns = 60'000;
// Nodes that there is room for at first, for each pixel; what is really wanted is told by the counter.
constexpr std::uint64_t nodesPerPixel = 2;

// With pages: counters, of which the tiles of an image take one after the other; words from one to the next,
// so that no two lie in one cache line; nodes of a page; pixels of a tile's side. On llvmpipe a thread draws
// tiles of 64 x 64 pixels whole, so that two threads meet in one counter only where they draw tiles that
// share it; many more tiles than counters hand out about as many nodes from each.
constexpr std::uint64_t pageCounters = 32, counterWords = 16, pageNodes = 32, tileSide = 16;

} // namespace

PassType ABufferStore::type() {
    return Describe<ABufferStore>("ABufferStore",
                                  "Stores every fragment of every view in a list of its pixel")
        .input("bounds", PortKind::Texture, "Depth bounds and number of fragments in the frame's view")
        .carries({.channels = 4, .space = Space::View})
        .input("cube_bounds", PortKind::Texture, "The same of the cube's faces")
        .carries({.channels = 4, .space = Space::View})
        .output("pixels", PortKind::Buffer,
                "What each pixel of each view knows of its list, unsorted; with `counted` nothing yet")
        .output("nodes", PortKind::Buffer, "The nodes: depth and links")
        .output("data", PortKind::Buffer, "The triangle of each node, where data is decoupled")
        .output("segments", PortKind::Buffer,
                "With `counted`: the pixel's first node, and the one after its last")
        .internal("counts", PortKind::Texture,
                  "With `counted`, where the bounds do not tell it: fragments in the frame's view")
        .internal("cube_counts", PortKind::Texture, "The same of the cube's faces")
        .internal("next", PortKind::Texture, "With `fetch`: the next node of each pixel of the frame's view")
        .internal("cube_next", PortKind::Texture, "The same of the cube's faces")
        .internal("counter", PortKind::Buffer, "Nodes in all")
        .internal("runs", PortKind::Buffer, "Fragments before each run of pixels")
        .choice("structure", &ABufferStore::structure, {"sb", "ll", "dll", "llb", "dllb"},
                "Side by side; linked one way or both ways; the same by buckets")
        .number("buckets", &ABufferStore::buckets, 1, 16, "buckets",
                "Parts of a pixel's depth range, with llb and dllb")
        .choice("boundaries", &ABufferStore::boundaries, {"uniform", "shifted"},
                "Of buckets: equal parts of the depth range, in which a depth's bucket is found at once; or "
                "where as many fragments lie in each, found by looking at one after the other")
        .flag("decoupled", &ABufferStore::decoupled,
              "Keeps what shading needs apart from what traversal needs")
        .flag("planes", &ABufferStore::planes,
              "Keeps with each fragment how its triangle's depth changes over the pixel: what is seen at a "
              "grazing angle is met where it lies, and needs no thickness")
        .choice("allocation", &ABufferStore::allocation, {"counter", "pages", "counted"},
                "Addresses from one counter, as in the paper; from one of several, which hand out pages and "
                "serve tiles of pixels in turn; or from how many fragments each pixel has. Always the last "
                "with sb")
        .choice("drawing", &ABufferStore::drawing, {"by_view", "geometry_shader", "vertex_layer"},
                "Triangles into the views: view after view, or into all in one draw by a geometry shader, as "
                "in the paper, or by instances")
        .flag("fetch", &ABufferStore::fetch,
              "With `counted`, view after view: fragments count in an attachment, without atomics, where the "
              "driver has GL_EXT_shader_framebuffer_fetch");
}

Declaration ABufferStore::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    FragmentLists lists = inputs["bounds"].desc.lists;
    const bool bucketed = structure == Structure::LLB || structure == Structure::DLLB;
    lists.structure = structure;
    lists.buckets = bucketed ? buckets : 1;
    lists.shifted = bucketed && boundaries == Boundaries::Shifted;
    lists.decoupled = decoupled;
    lists.planes = planes && lists.blended != Blended::Alone;
    if (planes && !lists.planes)
        declaration.leftOut.push_back({"planes", "blended surfaces alone lie where rays meet them"});
    if (inputs["bounds"].desc.lists != inputs["cube_bounds"].desc.lists)
        declaration.problems.push_back({"cube_bounds", "is of another pass than `bounds`"});
    if (structure == Structure::SB && allocation == ABufferAllocation::Counter)
        declaration.leftOut.push_back({"the one counter", "the nodes of sb lie side by side"});

    const std::uint64_t pixels = abufferPixels(lists, world.size);
    const std::uint64_t capacity = std::max(demand.grown("nodes"), nodesPerPixel * pixels);
    const bool nothing = !abufferHasFragments(lists, world.facts) || pixels == 0;
    const auto buffer = [&](const char* port, std::uint64_t words) -> Output& {
        const std::uint64_t bytes = std::max<std::uint64_t>(words, 1) * 4;
        if (static_cast<std::int64_t>(words) > world.capabilities.maxTextureBufferTexels)
            declaration.problems.push_back(
                {port,
                 fmt::format("needs {} texels in a buffer texture; the limit is {}", words,
                             world.capabilities.maxTextureBufferTexels),
                 true});
        Desc desc = Desc::buffer(bytes, Format::R32UI);
        desc.lists = lists;
        desc.extent = world.size; // the frame's view is told with every buffer
        declaration.outputs.push_back({.port = port, .desc = desc});
        return declaration.outputs.back();
    };
    const bool counted = isCounted();
    const glm::vec4 none(0);
    // Where nodes lie side by side nothing is kept of a pixel until its list is made (reorder).
    Output& words =
        buffer("pixels", counted ? 0 : pixels * static_cast<std::uint64_t>(abufferPixelWords(lists)));
    if (nothing || counted) words.constant = none;
    if (!nothing && !counted && !bucketed) words.clear = none;
    Output& nodes = buffer("nodes", capacity * static_cast<std::uint64_t>(abufferNodeWords(lists)));
    if (nothing) nodes.constant = none;
    if (!nothing) {
        nodes.counter = "counter";
        nodes.capacity = capacity;
    }
    const bool keepsData = decoupled && demand.reads("data");
    Output& data = buffer("data", keepsData ? capacity : 0);
    if (nothing || !keepsData) data.constant = none;
    if (decoupled && !keepsData)
        declaration.leftOut.push_back({"the triangles of fragments", "nobody reads them"});
    Output& segments = buffer("segments", counted ? 2 * pixels : 0);
    if (nothing || !counted) segments.constant = none;

    declaration.depends = Causes::Camera | Causes::Cut | Causes::Geometry | Causes::Transforms |
                          Causes::Materials | Causes::Properties | Causes::Size;
    if (nothing) {
        declaration.leftOut.push_back({"drawing", pixels == 0 ? "no view is asked for"
                                                  : world.facts.triangles == 0
                                                      ? "the scene has no triangles"
                                                      : "no material is blended, and others are not stored"});
        return declaration;
    }
    declaration.outputs.push_back(
        {.port = "counter",
         .desc = Desc::buffer(4 * (isPaged() ? counterWords * (1 + pageCounters) : 1)),
         .clear = none});
    if (!world.facts.hasMasked)
        declaration.leftOut.push_back({"alpha test", "no material is masked or blended"});
    if (const auto why = abufferCannotDraw(drawing, world.capabilities))
        declaration.problems.push_back({"", *why, true});
    if (countsItself(lists)) declareCounts(world, lists, declaration);
    const bool fetches = counted && fetch && abufferDrawing(drawing, lists) == ABufferDrawing::ByView &&
                         world.capabilities.has("GL_EXT_shader_framebuffer_fetch");
    if (counted && fetch && !fetches)
        declaration.leftOut.push_back(
            {"counting in an attachment", drawing == ABufferDrawing::ByView
                                              ? "the driver has no GL_EXT_shader_framebuffer_fetch"
                                              : "all views are drawn at once, without attachments"});
    if (fetches) {
        const auto side = static_cast<std::uint32_t>(lists.side);
        if (lists.mainView) {
            declaration.outputs.push_back(
                {.port = "next", .desc = Desc::texture2D(Format::R32UI, world.size)});
        }
        if (side > 0)
            declaration.outputs.push_back(
                {.port = "cube_next",
                 .desc = Desc::array2D(Format::R32UI, {side, side, shared::abufferFaces})});
    }
    if (counted || bucketed) {
        const std::uint64_t runs = (pixels + pixelsPerRun - 1) / pixelsPerRun;
        if (runs > maxRuns)
            declaration.problems.push_back(
                {"", fmt::format("{} pixels in all views; the limit is {}", pixels, maxRuns * pixelsPerRun),
                 true});
        if (counted) buffer("runs", runs);
        for (Step& step : beginSteps(abufferDefines(lists, world.size), lists, pixels, fetches))
            declaration.steps.push_back(std::move(step));
    }
    const bool both = lists.mainView && lists.side > 0;
    if (both && abufferDrawing(drawing, lists) != ABufferDrawing::ByView) {
        declaration.steps.push_back(drawStep(world, lists, ABufferViews::All, keepsData, fetches));
        return declaration;
    }
    if (lists.mainView)
        declaration.steps.push_back(drawStep(world, lists, ABufferViews::Frame, keepsData, fetches));
    if (lists.side > 0)
        declaration.steps.push_back(drawStep(world, lists, ABufferViews::Faces, keepsData, fetches));
    return declaration;
}

// The bounds are those of boxes, or rounded otherwise: fragments are counted here then.
void ABufferStore::declareCounts(const World& world, const FragmentLists& lists,
                                 Declaration& declaration) const {
    const auto faceSide = static_cast<std::uint32_t>(lists.side);
    const auto count = [&](const char* port, ABufferViews views, Desc desc) {
        desc.lists = lists;
        declaration.outputs.push_back({.port = port, .desc = desc, .clear = glm::vec4(0)});
        Step step = abufferSceneStep(world, lists, views, drawing, true, "abuffer/bounds.frag");
        step.name = views == ABufferViews::Faces ? "count_faces" : "count_frame";
        step.run = [lists, views, how = drawing](Commands& commands) {
            DrawState state = DrawState::overwrite();
            state.blend = Blend::Add;
            abufferDrawScene(commands, state, lists, commands.frame().size, views, how, true);
        };
        step.uses = {{.port = port, .access = Access::Attachment, .write = true}};
        step.group = "store";
        step.defines.insert({{"COUNT", "1"}, {"OUTPUT", std::string("out_") + port}});
        step.defines.emplace("VIEW_BLOCK", views == ABufferViews::Faces ? "CubeCountsView" : "CountsView");
        declaration.steps.push_back(std::move(step));
    };
    if (lists.mainView) count("counts", ABufferViews::Frame, Desc::texture2D(Format::R32F, world.size));
    if (lists.side > 0)
        count("cube_counts", ABufferViews::Faces,
              Desc::array2D(Format::R32F, {faceSide, faceSide, shared::abufferFaces}));
}

std::vector<Step> ABufferStore::beginSteps(const Defines& given, const FragmentLists& lists,
                                           std::uint64_t pixels, bool fetches) const {
    const auto runs = static_cast<std::uint32_t>((pixels + pixelsPerRun - 1) / pixelsPerRun);
    const auto stepOf = [&](const char* name, const char* what, bool reads, std::vector<Use> uses) {
        Step step{.name = name,
                  .shaders = {"abuffer/segments.comp"},
                  .defines = given,
                  .uses = std::move(uses),
                  .group = "store"};
        const bool scan = std::string_view(what) == "SCAN";
        step.defines.emplace(what, "1");
        step.defines.emplace("RUN", std::to_string(pixelsPerRun));
        step.defines.emplace("RUNS", std::to_string(runs));
        step.defines.emplace("PIXELS_IN_ALL", std::to_string(pixels));
        step.defines.emplace("LOCAL_SIZE", scan ? "1" : "8");
        step.run = [runs, scan](Commands& commands) { commands.dispatchOver(scan ? 1 : runs); };
        const bool counts = countsItself(lists);
        if (counts) step.defines.emplace("COUNTS", "1");
        const auto use = [&](bool used, const char* port, bool write) {
            if (used) step.uses.push_back({.port = port, .access = Access::Image, .write = write});
        };
        use(reads && lists.mainView, counts ? "counts" : "bounds", false);
        use(reads && lists.side > 0, counts ? "cube_counts" : "cube_bounds", false);
        if (std::string_view(what) == "PLACE") {
            use(fetches && lists.mainView, "next", true);
            use(fetches && lists.side > 0, "cube_next", true);
            step.defines.emplace(fetches ? "NEXT" : "COUNT_UP", "1");
        }
        return step;
    };
    const Use words{.port = "pixels", .access = Access::Image, .write = true};
    const Use runsWritten{.port = "runs", .access = Access::Image, .write = true};
    if (!isCounted()) {
        Step ranges = stepOf("ranges", "RANGES", true, {words});
        if (drawing != ABufferDrawing::ByView) ranges.defines.emplace("WIDEN", "1");
        return {std::move(ranges)};
    }
    return {stepOf("sum", "SUM", true, {runsWritten}),
            stepOf("scan", "SCAN", false,
                   {runsWritten, {.port = "counter", .access = Access::Storage, .write = true}}),
            stepOf("place", "PLACE", true,
                   {{.port = "runs", .access = Access::Image},
                    {.port = "segments", .access = Access::Image, .write = true}})};
}

Step ABufferStore::drawStep(const World& world, const FragmentLists& lists, ABufferViews views,
                            bool keepsData, bool fetches) const {
    Step step = abufferSceneStep(world, lists, views, drawing, fetches, "abuffer/store.frag", true);
    step.uses = {{.port = "nodes", .access = Access::Image, .write = true}};
    step.group = "store";
    if (keepsData) step.uses.push_back({.port = "data", .access = Access::Image, .write = true});
    if (keepsData) step.defines.emplace("KEEPS_DATA", "1");
    if (!isCounted()) {
        step.defines.emplace("COUNTER", "1");
        if (isPaged())
            step.defines.insert({{"PAGES", "1"},
                                 {"PAGE_COUNTERS", fmt::format("{}u", pageCounters)},
                                 {"COUNTER_WORDS", fmt::format("{}u", counterWords)},
                                 {"PAGE_NODES", fmt::format("{}u", pageNodes)},
                                 {"TILE_SIDE", std::to_string(tileSide)}});
        step.defines.emplace("VIEW_BLOCK", "PixelsView");
        step.uses.push_back({.port = "pixels", .access = Access::Image, .write = true});
        step.uses.push_back({.port = "counter", .access = Access::Storage, .write = true});
    } else if (fetches) {
        const bool faces = views == ABufferViews::Faces;
        step.defines.insert({{"NEXT", "1"}, {"OUTPUT", faces ? "out_cube_next" : "out_next"}});
        step.defines.emplace("VIEW_BLOCK", "SegmentsView");
        step.uses.push_back(
            {.port = faces ? "cube_next" : "next", .access = Access::Attachment, .write = true});
    } else {
        step.defines.emplace("VIEW_BLOCK", "SegmentsView");
        step.uses.push_back({.port = "segments", .access = Access::Image, .write = true});
    }
    step.run = [lists, views, how = drawing, keepsData, fetches](Commands& commands) {
        const int nodeWords = abufferNodeWords(lists);
        commands.set("capacity", static_cast<std::uint32_t>(commands.desc("nodes").bytes / 4) /
                                     static_cast<std::uint32_t>(nodeWords));
        // As in Table 2.
        commands.report("bytes a pixel", 4 * abufferPixelWords(lists));
        commands.report("bytes a fragment", 4 * nodeWords);
        commands.report("bytes of data a fragment", keepsData ? 4 : 0);
        DrawState state = DrawState::overwrite();
        state.byNumber = true;
        abufferDrawScene(commands, state, lists, commands.frame().size, views, how, fetches);
    };
    return step;
}

} // namespace kestrel
