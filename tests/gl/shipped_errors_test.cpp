// No shipped graph prints a GL error on any built-in scene: labels, limits and states included.
#include "scene/builtin.h"
#include "shipped_fixture.h"

namespace kestrel::test {
namespace {

struct ShippedErrors : ShippedTest {};

TEST_F(ShippedErrors, NoGraphPrintsOneOnAnyBuiltinScene) {
    for (const std::string& name : shippedGraphNames()) {
        std::optional<Renderer> made;
        for (const std::string& scene : builtinNames()) {
            const std::uint64_t before = gl::Context::severeErrors();
            Scene small = loadScene("builtin:" + scene + "?detail=0.02");
            if (!made) {
                Graph graph = shippedGraph(name);
                // References cost what their samples do.
                for (const GraphPass& pass : std::vector<GraphPass>(graph.passes))
                    if (const PropertyInfo* samples = shipped().find(pass.type)->property("samples");
                        samples != nullptr && samples->kind == PropertyKind::Int)
                        applySetting(
                            graph, shipped(),
                            fmt::format("{}.samples={}", pass.name, std::max(1.0, samples->minimum)));
                RenderOptions options;
                options.size = {48, 27, 1};
                made.emplace(std::move(graph), shipped(), std::move(small), context().capabilities(),
                             options);
            } else {
                made->setScene(std::move(small));
            }
            made->frame();
            EXPECT_EQ(gl::Context::severeErrors(), before) << name << " on " << scene;
        }
    }
}

} // namespace
} // namespace kestrel::test
