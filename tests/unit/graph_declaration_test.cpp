// Mistakes of passes: each is found when the graph is compiled, and says whose it is.
#include "graph_mock.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdexcept>

namespace kestrel {
namespace {

using namespace test;
using testing::ElementsAre;

// Compiles `p` alone, fed by a 16x16 texture, and returns the message without "g:L:C: pass 'p' (P)".
std::string mistake(const Declare& declare, const CompileOptions& options = {}) {
    Registry registry;
    registry.add(mockType("S", {out("a"), out("buffer", PortKind::Buffer), out("tracer", PortKind::Tracer)},
                          [](const World&, const Inputs&, const Demand& demand) {
                              Declaration d;
                              d.outputs = {output("a")};
                              d.steps = {step("s", {writes("a")})};
                              if (demand.reads("buffer")) {
                                  d.outputs.push_back(output("buffer", Desc::buffer(64)));
                                  d.steps[0].uses.push_back(writes("buffer", Access::Storage));
                              }
                              if (demand.reads("tracer")) {
                                  Module module;
                                  module.port = "tracer";
                                  module.shader = "t.glsl";
                                  d.modules = {module};
                              }
                              return d;
                          }));
    registry.add(mockType("P",
                          {in("x"), opt("y"), in("buffer", PortKind::Buffer), opt("tracer", PortKind::Tracer),
                           opt("tracer2", PortKind::Tracer), out("r"), internal("scratch"),
                           internal("data", PortKind::Buffer), out("module", PortKind::Tracer)},
                          declare));
    const std::string text = R"({"kestrel": 1, "passes": {"s": {"type": "S"},
"p": {"type": "P"}},
"edges": [["s.a", "p.x"],
["s.buffer", "p.buffer"],
["s.tracer", "p.tracer"]], "outputs": ["p.r"]})";
    return messageOf<Error>([&] { compileText(text, registry, options); });
}

// A correct declaration, changed by `spoil`.
Declare spoilt(const std::function<void(Declaration&)>& spoil) {
    return [spoil](const World&, const Inputs&, const Demand&) {
        Declaration d;
        d.outputs = {output("r")};
        d.steps = {step("s", {reads("x"), writes("r")})};
        spoil(d);
        return d;
    };
}

TEST(Declaration, TheBaseOfTheseTestsIsCorrect) {
    EXPECT_EQ(mistake(spoilt([](Declaration&) {})), "no error");
}

TEST(Declaration, UsesOfPortsAreChecked) {
    const auto use = [](Use bad) {
        return mistake(spoilt([bad](Declaration& d) { d.steps[0].uses.push_back(bad); }));
    };
    EXPECT_EQ(use(reads("bufer")),
              "g.json:2:1: pass 'p' (P): the step 's' uses 'bufer', a port that the type does not "
              "have (did you mean 'buffer'?)");
    EXPECT_EQ(use(reads("y")),
              "g.json:2:1: pass 'p' (P), 'y': the step 's' reads it, but it is not connected");
    EXPECT_EQ(
        use(writes("x")),
        "g.json:3:11: pass 'p' (P), 'x': the step 's' writes an input; an output that updates it is needed");
    EXPECT_EQ(use(writes("scratch")),
              "g.json:2:1: pass 'p' (P), 'scratch': the step 's' uses it, but no output is declared for it");
    EXPECT_EQ(use(reads("tracer")),
              "g.json:5:1: pass 'p' (P), 'tracer': the step 's' uses a module like a resource");
    EXPECT_EQ(use(reads("x", Access::Storage)),
              "g.json:3:11: pass 'p' (P), 'x': the step 's' uses a texture by storage");
    EXPECT_EQ(
        use(reads("buffer")),
        "g.json:4:1: pass 'p' (P), 'buffer': the step 's' reads texels of a buffer that has no texel format");
    EXPECT_EQ(use(reads("buffer", Access::Attachment)),
              "g.json:4:1: pass 'p' (P), 'buffer': the step 's' uses a buffer by attachment");
    EXPECT_EQ(use(writes("r", Access::Fetch)), "g.json:2:1: pass 'p' (P), 'r': the step 's' writes by fetch");
    Use deep = reads("x");
    deep.mip = 3;
    EXPECT_EQ(use(deep), "g.json:3:11: pass 'p' (P), 'x': the step 's' uses mip 3 of 1");
    Use past = writes("r");
    past.previous = true;
    EXPECT_EQ(use(past), "g.json:2:1: pass 'p' (P), 'r': the step 's' writes the content of the last frame");
    EXPECT_EQ(mistake(spoilt([](Declaration& d) {
                  d.steps[0].uses = {writes("r", Access::Attachment), reads("r")};
              })),
              "g.json:2:1: pass 'p' (P), 'r': the step 's' reads the texture that it renders to");
}

TEST(Declaration, OutputsAreChecked) {
    const auto made = [](const Output& bad, bool written = false) {
        return mistake(spoilt([=](Declaration& d) {
            d.outputs.push_back(bad);
            if (written) d.steps[0].uses.push_back(writes(bad.port, Access::Storage));
        }));
    };
    EXPECT_EQ(made(output("rr")),
              "g.json:2:1: pass 'p' (P): declares the output 'rr', a port that the type does not "
              "have (did you mean 'r'?)");
    EXPECT_EQ(made(output("r")), "g.json:2:1: pass 'p' (P), 'r': is declared twice");
    EXPECT_EQ(made(output("x")),
              "g.json:3:11: pass 'p' (P), 'x': is an input and cannot be declared as an output");
    EXPECT_EQ(made(output("data")),
              "g.json:2:1: pass 'p' (P), 'data': is a buffer port, but a rgba16f 16x16 is declared");
    EXPECT_EQ(made(output("scratch", Desc::texture2D(Format::None, {1, 1}))),
              "g.json:2:1: pass 'p' (P), 'scratch': the texture has no format");
    EXPECT_EQ(made(output("scratch", image(0))),
              "g.json:2:1: pass 'p' (P), 'scratch': the texture rgba16f 0x0 is empty");
    EXPECT_EQ(made(output("scratch", image(20000))), "g.json:2:1: pass 'p' (P), 'scratch': the texture "
                                                     "rgba16f 20000x20000 is larger than the device allows "
                                                     "(16384 a side, 2048 layers)");
    EXPECT_EQ(made(output("data", Desc::buffer(0))),
              "g.json:2:1: pass 'p' (P), 'data': the buffer has no bytes");
    EXPECT_EQ(
        made(output("data", Desc::buffer(std::uint64_t{1} << 28)), true),
        "g.json:2:1: pass 'p' (P), 'data': the step 's' needs a storage block of 268435456 bytes; the device "
        "allows 134217728");
    EXPECT_EQ(made(output("module", Desc::module(0))),
              "g.json:2:1: pass 'p' (P), 'module': no module file is declared for it");
    Output both = output("scratch");
    both.clear = both.constant = glm::vec4(0);
    EXPECT_EQ(made(both),
              "g.json:2:1: pass 'p' (P), 'scratch': can be only one of same, updates, constant and clear");
    Output like = output("scratch");
    like.same = "y";
    EXPECT_EQ(made(like),
              "g.json:2:1: pass 'p' (P), 'scratch': refers to the input 'y', which is not connected");
    like.same = "buffer";
    EXPECT_THAT(made(like), testing::HasSubstr("cannot be 'buffer', which is not an input of its kind"));
    EXPECT_EQ(mistake(spoilt([](Declaration& d) { d.steps[0].uses.pop_back(); })),
              "g.json:2:1: pass 'p' (P), 'r': no step writes this output");
    EXPECT_EQ(mistake(spoilt([](Declaration& d) {
                  d.steps.clear();
                  d.outputs[0].clear = glm::vec4(0);
              })),
              "g.json:2:1: pass 'p' (P), 'r': no step writes this output\n"
              "g.json:2:1: pass 'p' (P), 'r': has a clear value, but there is no step that it is set before");
}

TEST(Declaration, StepsAndModulesAreChecked) {
    EXPECT_EQ(mistake(spoilt([](Declaration& d) { d.steps.push_back(d.steps[0]); })),
              "g.json:2:1: pass 'p' (P): the step 's' is declared twice");
    EXPECT_EQ(mistake(spoilt([](Declaration& d) { d.steps[0].name.clear(); })),
              "g.json:2:1: pass 'p' (P): a step has no name");
    const auto includes = [](const std::string& port) {
        return mistake(spoilt([port](Declaration& d) { d.steps[0].modules = {{port, requests::AnyHit}}; }));
    };
    EXPECT_EQ(includes("tracer"), "no error");
    EXPECT_EQ(includes("trace"),
              "g.json:2:1: pass 'p' (P): the step 's' includes 'trace', a port that the type does "
              "not have (did you mean 'tracer'?)");
    EXPECT_EQ(includes("x"),
              "g.json:3:11: pass 'p' (P), 'x': the step 's' includes it, but it is no module input");
    EXPECT_EQ(includes("tracer2"),
              "g.json:2:1: pass 'p' (P), 'tracer2': the step 's' includes it, but it is not connected");
}

TEST(Declaration, AllMistakesComeAtOnce) {
    EXPECT_EQ(mistake(spoilt([](Declaration& d) {
                  d.problems = {{"", "this cannot work"}, {"x", "is too small"}};
                  d.steps[0].uses.push_back(reads("y"));
              })),
              "g.json:2:1: pass 'p' (P): this cannot work\n"
              "g.json:2:1: pass 'p' (P), 'y': the step 's' reads it, but it is not connected\n"
              "g.json:3:11: pass 'p' (P), 'x': is too small");
}

TEST(Declaration, AnExceptionNamesThePass) {
    EXPECT_EQ(mistake([](const World&, const Inputs&, const Demand&) -> Declaration {
                  throw std::runtime_error("out of ideas");
              }),
              "pass 'p' failed in declare: out of ideas");
}

TEST(Declaration, WhatIsPromisedMustBeKept) {
    Registry registry;
    registry.add(mockType("Fickle", {out("a")}, [](const World&, const Inputs&, const Demand& demand) {
        return demand == Demand::everything() ? simple({}, {"a"})({}, {}, demand) : Declaration();
    }));
    registry.add(mockType("Reader", {in("x"), out("r")}, simple({"x"}, {"r"})));
    EXPECT_EQ(messageOf([&] {
                  compileText(R"({"kestrel": 1, "passes": {"f": {"type": "Fickle"}, "r": {"type": "Reader"}},
                      "edges": [["f.a", "r.x"]], "outputs": ["r.r"]})",
                              registry);
              }),
              "g.json:1:27: pass 'f' (Fickle) does not declare 'a' any more when 'r' asks for it");
}

TEST(Declaration, ADemandThatNeverSettlesIsAnError) {
    Registry registry;
    registry.add(
        mockType("Source", {out("a"), out("b")}, [](const World&, const Inputs&, const Demand& demand) {
            Declaration d = simple({}, {"a", "b"})({}, {}, demand);
            // Constant exactly when somebody asks for the other one.
            if (demand.reads("b") && demand.reads("a")) d.outputs[0].constant = glm::vec4(1);
            return d;
        }));
    registry.add(
        mockType("Reader", {in("x"), in("y"), out("r")}, [](const World&, const Inputs& in, const Demand&) {
            Declaration d;
            d.outputs = {output("r")};
            d.steps = {step("s", {reads("x"), writes("r")})};
            if (!in["x"].constant) d.steps[0].uses.push_back(reads("y"));
            return d;
        }));
    EXPECT_EQ(messageOf([&] {
                  compileText(R"({"kestrel": 1, "passes": {"s": {"type": "Source"}, "r": {"type": "Reader"}},
                      "edges": [["s.a", "r.x"], ["s.b", "r.y"]], "outputs": ["r.r"]})",
                              registry);
              }),
              "g.json: the passes' declarations do not settle: one asks for more when less is asked of it");
}

TEST(Declaration, KeepAllFallsBackToWhatAPassCanBear) {
    CompileOptions keep;
    keep.keepAll = true;
    EXPECT_EQ(mistake(
                  [](const World&, const Inputs&, const Demand& demand) {
                      Declaration d = simple({"x"}, {"r"})({}, {}, demand);
                      if (demand.reads("scratch")) d.problems = {{"scratch", "needs an extension"}};
                      return d;
                  },
                  keep),
              "no error");
}

TEST(Declaration, LayersOfUsesAreChecked) {
    const auto use = [](Use bad) {
        return mistake(spoilt([bad](Declaration& d) {
            d.outputs[0].desc = Desc::array2D(Format::R32F, {4, 4, 3});
            d.steps[0].uses = {reads("x"), bad};
        }));
    };
    const auto layer = [](Use of, int number) {
        of.layer = number;
        return of;
    };
    EXPECT_EQ(use(layer(writes("r"), 2)), "no error");
    EXPECT_EQ(use(layer(writes("r", Access::Attachment), 2)), "no error");
    EXPECT_EQ(use(layer(writes("r"), 3)), "g.json:2:1: pass 'p' (P), 'r': the step 's' uses layer 3 of 3");
    EXPECT_EQ(
        mistake(spoilt([&](Declaration& d) { d.steps[0].uses[0] = layer(reads("x", Access::Fetch), 0); })),
        "g.json:3:11: pass 'p' (P), 'x': the step 's' uses layer 0 of a texture by fetch, which has no "
        "layers");
}

TEST(Views, AreTakenApartByWhatTheyLookFrom) {
    const View frame{}, camera{.source = CameraView{.camera = 1}}, named{.source = CameraView{.name = "top"}},
        eye{.source = CubeView{.face = 2}},
        place{.source = CubeView{.face = 2, .point = glm::vec3(1, 2, 3), .farPlane = 0, .side = 64}},
        light{.source = LightView{.light = 3, .face = 1}};
    EXPECT_EQ(describe(frame), "");
    EXPECT_EQ(describe(camera), "camera 1");
    EXPECT_EQ(describe(named), "camera 'top'");
    EXPECT_EQ(describe(eye), "cube face 2 about the eye, from 0.01 to 100");
    EXPECT_EQ(describe(place), "cube face 2 about (1, 2, 3), from 0.01 to infinity, 64 pixels a side");
    EXPECT_EQ(describe(light), "light 3, face 1");
    EXPECT_EQ(describe(Desc::texture2D(Format::R32F, {4, 4, 1}, camera)), "r32f 4x4 seen by camera 1");
    EXPECT_NE(eye, place);
    EXPECT_NE(frame, camera);
    EXPECT_EQ(causesOf(frame), Causes::None);
    EXPECT_EQ(causesOf(camera), Causes::Cameras);
    EXPECT_EQ(causesOf(eye), Causes::Camera | Causes::Cut);
    EXPECT_EQ(causesOf(place), Causes::None);
    EXPECT_EQ(causesOf(light), Causes::Lights);
    World world;
    world.size = {640, 360, 1};
    EXPECT_EQ(world.extentOf(camera), (Extent{640, 360, 1}));
    EXPECT_EQ(world.extentOf(eye), (Extent{360, 360, 1}));
    EXPECT_EQ(world.extentOf(place), (Extent{64, 64, 1}));
}

} // namespace
} // namespace kestrel
