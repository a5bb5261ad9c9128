// Every variant of the occupancy shaders that the passes can choose compiles.
#include "passes/occupancy/tracing.h"
#include "shader/validate.h"
#include "support/folders.h"
#include <algorithm>
#include <gtest/gtest.h>

namespace kestrel::test {
namespace {

using Choices = std::map<std::string, std::vector<std::string>>;

const std::vector<std::pair<int, std::string>> sizes = {{32, "5"}, {64, "6"}, {128, "7"}, {256, "8"}};

Defines sized(Defines defines, int resolution) {
    defines.merge(columnDefines(resolution));
    return defines;
}

void expectValid(const ProgramRequest& request, ShaderLibrary& library) {
    std::string text;
    for (const Problem& problem : validate(compose(request, library))) text += problem.text() + "\n";
    for (const auto& [name, value] : request.defines)
        if (!text.empty()) text += name + "=" + value + " ";
    EXPECT_EQ(text, "");
}

ShaderLibrary shippedShaders() { return ShaderLibrary({test::sourceFolder() / "shaders"}); }

// A consumer of a tracer that asks all there is.
void addConsumer(ShaderLibrary& library) {
    library.addVirtual("consumer.comp",
                       "#include \"lib/tracer.glsl\"\n"
                       "#include <port:tracer>\n"
                       "layout(local_size_x = 8) in;\n"
                       "layout(std430) buffer Result { float result[]; };\n"
                       "void main() {\n"
                       "    Ray ray = surfaceRay(vec3(0.0), vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0));\n"
                       "    tracer_aim(ray);\n"
                       "    Hit hit;\n"
                       "    bool found = tracer_closestHit(ray, hit);\n"
                       "    result[0] = tracer_anyHit(ray) ? ray.weight : found ? hit.t : 0.0;\n"
                       "}\n");
}

TEST(OccupancyShaders, RotateCompiles) {
    ShaderLibrary library = shippedShaders();
    for (const auto& [n, bits] : sizes)
        for (Defines defines : allCombinations({{"BASE_STORAGE", {undefinedChoice, "1"}},
                                                {"IN_TURN", {undefinedChoice, "1"}},
                                                {"LEVELS", {undefinedChoice, "3"}},
                                                {"DIRECTIONS", {"4", "256"}}})) {
            defines["RESOLUTION_BITS"] = bits;
            expectValid({{"occupancy/rotate.comp"}, sized(defines, n), {}}, library);
        }
}

TEST(OccupancyShaders, TheTracerCompilesForEveryConsumer) {
    ShaderLibrary library = shippedShaders();
    addConsumer(library);
    const Choices choices = {{"REQUESTS_SNAP", {undefinedChoice, "1"}},
                             {"MAPS_STORAGE", {undefinedChoice, "1"}},
                             {"COUNT_EXHAUSTED", {undefinedChoice, "1"}},
                             {"EMPTY", {undefinedChoice, "1"}}};
    for (const auto& [n, bits] : sizes)
        for (const Defines& chosen : allCombinations(choices))
            for (const char* iterations : {"", "KESTREL_COUNT_ITERATIONS"}) {
                Defines defines = sized(chosen, n);
                defines["DIRECTIONS"] = "16";
                defines["ANGULAR"] = "4";
                defines["ITERATIONS"] = "8";
                for (const char* file : {"occupancy/roma.glsl", "occupancy/roma_cascade.glsl"}) {
                    if (std::string_view(file) == "occupancy/roma_cascade.glsl") defines["LEVELS"] = "3";
                    ProgramRequest request{{"consumer.comp"}, {}, {{"tracer", {file, defines, {}}}}};
                    if (*iterations) request.defines[iterations] = "1";
                    expectValid(request, library);
                }
            }
}

TEST(OccupancyShaders, WalkingThroughTheMapCompilesForEveryConsumer) {
    ShaderLibrary library = shippedShaders();
    addConsumer(library);
    const Choices choices = {{"METHOD", {"0", "1", "2"}},
                             {"MAP_STORAGE", {undefinedChoice, "1"}},
                             {"COUNT_EXHAUSTED", {undefinedChoice, "1"}},
                             {"EMPTY", {undefinedChoice, "1"}}};
    for (const auto& [n, bits] : sizes) {
        for (const Defines& chosen : allCombinations(choices))
            for (const char* iterations : {"", "KESTREL_COUNT_ITERATIONS"}) {
                Defines defines = sized(chosen, n);
                defines["ITERATIONS"] = "1024";
                defines["TOP_LEVEL"] = "3";
                ProgramRequest request{
                    {"consumer.comp"}, {}, {{"tracer", {"occupancy/occupancy_trace.glsl", defines, {}}}}};
                if (*iterations) request.defines[iterations] = "1";
                expectValid(request, library);
            }
        for (const Defines& chosen : allCombinations({{"COARSER", {undefinedChoice, "1"}}}))
            expectValid({{"occupancy/columns.comp"}, sized(chosen, n), {}}, library);
    }
}

const Choices materials = {{"MATERIAL_MASKED", {undefinedChoice, "1"}},
                           {"MATERIAL_COLOURS", {undefinedChoice, "1"}}};

TEST(OccupancyShaders, TheMapCompilesByEveryMethod) {
    ShaderLibrary library = shippedShaders();
    for (const auto& [n, bits] : sizes) {
        expectValid({{"occupancy/merge.comp"}, sized({}, n), {}}, library);
        for (const Defines& chosen : allCombinations(materials)) {
            const Defines defines = sized(chosen, n);
            Defines map = defines, dominant = defines, columns = defines, exact = defines, large = defines;
            map["INTO_MAP"] = dominant["INTO_MAP"] = dominant["FACE_BY_TRIANGLE"] = "1";
            expectValid({{"occupancy/raster.vert", "occupancy/raster.frag"}, map, {}}, library);
            expectValid(
                {{"occupancy/raster.vert", "occupancy/raster.geom", "occupancy/raster.frag"}, dominant, {}},
                library);
            columns["INTO_COLUMNS"] = "1";
            columns["COLUMNS_LOW"] = "out_columns_x";
            if (n > 128) columns["COLUMNS_HIGH"] = "out_columns_x_high";
            expectValid({{"occupancy/raster.vert", "occupancy/raster.frag"}, columns, {}}, library);
            columns["BY_INTERLOCK"] = "1";
            columns["COLUMNS_LOW"] = "columns_x";
            if (n > 128) columns["COLUMNS_HIGH"] = "columns_x_high";
            expectValid({{"occupancy/raster.vert", "occupancy/raster.frag"}, columns, {}}, library);
            large["LARGE"] = "1";
            large["KESTREL_COUNT_ITERATIONS"] = exact["KESTREL_COUNT_ITERATIONS"] = "1";
            expectValid({{"occupancy/exact.comp"}, exact, {}}, library);
            expectValid({{"occupancy/exact.comp"}, large, {}}, library);
            exact["LEVELS"] = large["LEVELS"] = "3";
            expectValid({{"occupancy/exact.comp"}, exact, {}}, library);
            expectValid({{"occupancy/exact.comp"}, large, {}}, library);
        }
    }
}

} // namespace
} // namespace kestrel::test
