// The module interface `layers` between a toy provider and a consumer.
#include "execute_fixture.h"

namespace kestrel::test {
namespace {

class LayersTest : public ExecuteTest {};

// A map of half the frame's resolution with two layers: at (x, y) the depths x + 1 and none.
TEST_F(LayersTest, AConsumerFindsTheSamplesThatTheProviderTook) {
    shader("toy.glsl", R"(#include "lib/layers.glsl"
        layout(r32f) uniform readonly image2D M(samples);
        const int M(count) = 2;
        ivec2 M(texel)(vec2 uv) {
            ivec2 size = imageSize(M(samples));
            return clamp(ivec2(floor(uv * vec2(size))), ivec2(0), size - 1);
        }
        vec2 M(position)(ivec2 texel) { return (vec2(texel) + 0.5) / vec2(imageSize(M(samples))); }
        float M(depth)(ivec2 texel, int layer) { return layer == 0 ? imageLoad(M(samples), texel).x : noLayer; })");
    shader("fill_map.comp", R"(layout(local_size_x = 8, local_size_y = 8) in;
        layout(r32f) uniform writeonly image2D samples;
        void main() { imageStore(samples, ivec2(gl_GlobalInvocationID.xy), vec4(gl_GlobalInvocationID.x + 1u)); })");
    shader("look.comp", R"(#include <port:layers>
        layout(local_size_x = 8, local_size_y = 8) in;
        layout(rgba32f) uniform writeonly image2D result;
        void main() {
            ivec2 p = ivec2(gl_GlobalInvocationID.xy);
            ivec2 texel = layers_texel((vec2(p) + 0.5) / vec2(imageSize(result)));
            int found = 0;
            for (int i = 0; i < layers_count; ++i)
                if (layers_depth(texel, i) < noLayer) ++found;
            imageStore(result, p, vec4(layers_depth(texel, 0), found, layers_position(texel)));
        })");
    const View half{.divisor = 2};
    Describe<FunctionPass> map("Map", "A toy");
    map.output("layers", PortKind::Layers, "Two layers").internal("samples", PortKind::Texture, "The nearer");
    PassType mapType = map;
    mapType.make = [half] {
        auto pass = std::make_unique<FunctionPass>();
        pass->onDeclare = [half](const FunctionPass&, const World& world, const Inputs&) {
            Declaration declaration;
            declaration.outputs = {
                {.port = "samples", .desc = Desc::texture2D(Format::R32F, world.extentOf(half), half)},
                {.port = "layers", .desc = Desc::layersModule({.count = 2, .ordered = true}, half)}};
            declaration.modules = {{.port = "layers", .shader = "toy.glsl", .uses = {read("samples")}}};
            declaration.steps = {stepOf("fill", {"fill_map.comp"}, {write("samples")})};
            return declaration;
        };
        pass->onExecute = [](FunctionPass&, const Step&, Commands& commands) { overFrame(commands); };
        return pass;
    };
    registry_.add(std::move(mapType));
    Describe<FunctionPass> look("Look", "A consumer");
    look.input("layers", PortKind::Layers, "Samples").output("result", PortKind::Texture, "What is found");
    PassType lookType = look;
    lookType.make = [] {
        auto pass = std::make_unique<FunctionPass>();
        pass->onDeclare = [](const FunctionPass&, const World& world, const Inputs& inputs) {
            EXPECT_EQ(inputs["layers"].desc.depthLayers.count, 2);
            EXPECT_EQ(inputs["layers"].desc.view.divisor, 2);
            Declaration declaration;
            declaration.outputs = {imageOf(world, "result", Format::RGBA32F)};
            declaration.steps = {stepOf("look", {"look.comp"}, {write("result")})};
            declaration.steps[0].modules = {{"layers"}};
            return declaration;
        };
        pass->onExecute = [](FunctionPass&, const Step&, Commands& commands) { overFrame(commands); };
        return pass;
    };
    registry_.add(std::move(lookType));

    const Graph graph = [&] {
        Graph made;
        made.passes = {{.name = "map",
                        .type = "Map",
                        .properties = {},
                        .bound = {},
                        .position = {},
                        .comment = {},
                        .where = {},
                        .propertyWhere = {}},
                       {.name = "look",
                        .type = "Look",
                        .properties = {},
                        .bound = {},
                        .position = {},
                        .comment = {},
                        .where = {},
                        .propertyWhere = {}}};
        made.edges = {{{"map", "layers"}, {"look", "layers"}, {}}};
        made.outputs = {{{"look", "result"}, {}}};
        return made;
    }();
    const auto renderer = rendererOf(graph); // 8 x 4
    renderer->frame();
    const Image image = renderer->read({"look", "result"});
    for (int x = 0; x < 8; ++x) {
        EXPECT_EQ(image.at(x, 1, 0), static_cast<float>(x / 2 + 1)) << x;
        EXPECT_EQ(image.at(x, 1, 1), 1.0f);
        EXPECT_EQ(image.at(x, 1, 2), (static_cast<float>(x / 2) + 0.5f) / 4);
    }
}

} // namespace
} // namespace kestrel::test
