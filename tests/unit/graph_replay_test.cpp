// The property that a plan must have: on shared objects, with passes that are skipped when nothing changed,
// every reader sees what its producer makes, and no access lacks a barrier. Random graphs are replayed on a
// toy device whose textures and buffer places hold one number each, and compared with an interpreter that
// knows the graph only.
#include "graph/barriers.h"
#include "graph_mock.h"
#include <gtest/gtest.h>
#include <random>

namespace kestrel {
namespace {

using namespace test;

using Token = std::uint64_t;
Token mix(Token a, Token b) {
    a ^= b + 0x9E3779B97F4A7C15ULL + (a << 6) + (a >> 2);
    a *= 0xBF58476D1CE4E5B9ULL;
    return a ^ (a >> 31);
}
Token hashOf(const std::string& text) { return std::hash<std::string>()(text); }

// How one random pass behaves. Ports: in0..in2 (optional textures), base (optional, updated), m (optional
// tracer), out0, out1, updated, scratch, tracer.
struct Behaviour {
    Causes depends = Causes::None;
    std::map<std::string, PortRef> feeds;
    Desc desc, scratch; // of its outputs and of its scratch
    bool twoSteps = false, clears = false, history = false, sameOut1 = false, constantOut1 = false;
    bool providesModule = false;
    Access writeAccess = Access::Image, scratchWrites = Access::Image;
    Access readAccess = Access::Fetch;
    [[nodiscard]] bool fed(const std::string& port) const { return feeds.contains(port); }
};

const std::vector<std::string> textureInputs = {"in0", "in1", "in2"};
const glm::vec4 clearValue(7), constantValue(3);

Declaration declareRandom(const Behaviour& how, const Inputs& in, const Demand& demand) {
    Declaration d;
    d.depends = how.depends;
    d.always = how.history;
    const Desc& desc = how.desc;
    const bool needsScratch = how.twoSteps || (how.providesModule && demand.reads("tracer"));
    Step last = step("last", {});
    for (const std::string& port : textureInputs)
        if (in.connected(port)) last.uses.push_back(reads(port, how.readAccess));
    if (in.connected("m")) last.modules.push_back({"m", requests::AnyHit});
    if (needsScratch) {
        Output scratch = output("scratch", how.scratch);
        if (how.clears) scratch.clear = clearValue;
        d.outputs.push_back(scratch);
        Step first = step("first", {writes("scratch", how.scratchWrites)});
        if (in.connected("in0")) first.uses.push_back(reads("in0"));
        d.steps.push_back(first);
        last.uses.push_back(reads("scratch"));
    }
    const auto writeOut = [&](const std::string& port) {
        d.outputs.push_back(output(port, desc));
        last.uses.push_back(writes(port, how.writeAccess));
    };
    if (demand.reads("out0")) {
        writeOut("out0");
        if (how.history) {
            Use previous = reads("out0");
            previous.previous = true;
            last.uses.push_back(previous);
        }
    }
    if (demand.reads("out1")) {
        if (how.sameOut1 && in.connected("in0")) {
            d.outputs.push_back(output("out1"));
            d.outputs.back().same = "in0";
        } else if (how.constantOut1) {
            d.outputs.push_back(output("out1", desc));
            d.outputs.back().constant = constantValue;
        } else {
            writeOut("out1");
        }
    }
    if (demand.reads("updated") && in.connected("base")) {
        d.outputs.push_back(output("updated"));
        d.outputs.back().updates = "base";
        last.uses.push_back(writes("updated", how.writeAccess));
    }
    if (how.providesModule && demand.reads("tracer")) {
        d.outputs.push_back(output("tracer", Desc::module(0)));
        Module module;
        module.port = "tracer";
        module.shader = "t.glsl";
        module.uses = {reads("scratch", how.readAccess)};
        if (in.connected("in1")) module.uses.push_back(reads("in1"));
        if (in.connected("m")) module.modules = {{"m", requests::AnyHit}};
        d.modules = {module};
    }
    const bool work =
        std::any_of(last.uses.begin(), last.uses.end(), [](const Use& use) { return use.write; });
    if (work) d.steps.push_back(last);
    return d;
}

struct RandomGraph {
    std::map<std::string, Behaviour> passes;
    std::vector<std::string> names;
    std::vector<PortRef> outputs;
    Registry registry;
    Graph graph;
};

RandomGraph makeGraph(std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
    RandomGraph made;
    const std::uint32_t count = 3 + below(12);
    for (std::uint32_t i = 0; i < count; ++i) made.names.push_back("p" + std::to_string(i));
    // Ports are textures in one half of the graphs and buffers in the other; scratch is either.
    const bool buffers = below(2) == 0;
    const auto anyDesc = [&](bool buffer) {
        return buffer ? Desc::buffer(256 * (1 + below(6)), Format::R32UI) : image(below(4) == 0 ? 16 : 8);
    };
    const auto anyWrite = [&](bool buffer) {
        constexpr std::array writeKinds = {Access::Image, Access::Copy, Access::Attachment};
        const Access access = writeKinds[below(3)];
        return buffer && access == Access::Attachment ? Access::Storage : access;
    };
    std::vector<PortRef> images, tracers;
    for (const std::string& name : made.names) {
        Behaviour how;
        constexpr std::array causes = {Causes::Frame, Causes::Frame, Causes::None, Causes::Lights};
        how.depends = causes[below(4)];
        const bool scratchIsBuffer = below(2) == 0;
        how.desc = anyDesc(buffers);
        how.scratch = anyDesc(scratchIsBuffer);
        how.writeAccess = anyWrite(buffers);
        how.scratchWrites = anyWrite(scratchIsBuffer);
        how.twoSteps = below(3) == 0;
        how.clears = below(2) == 0;
        how.history = below(6) == 0;
        how.sameOut1 = below(4) == 0;
        how.constantOut1 = below(4) == 0;
        how.providesModule = below(4) == 0;
        how.readAccess = below(2) == 0 ? Access::Fetch : Access::Image;
        for (const std::string& port : textureInputs)
            if (!images.empty() && below(2) == 0)
                how.feeds[port] = images[below(static_cast<std::uint32_t>(images.size()))];
        if (!images.empty() && below(3) == 0)
            how.feeds["base"] = images[below(static_cast<std::uint32_t>(images.size()))];
        if (!tracers.empty() && below(2) == 0)
            how.feeds["m"] = tracers[below(static_cast<std::uint32_t>(tracers.size()))];
        images.push_back({name, "out0"});
        images.push_back({name, "out1"});
        if (how.fed("base")) images.push_back({name, "updated"});
        if (how.providesModule) tracers.push_back({name, "tracer"});
        made.passes[name] = how;
    }
    std::set<PortRef> wanted;
    for (std::uint32_t i = 0; i < 1 + below(3); ++i)
        wanted.insert(images[images.size() - 1 -
                             below(static_cast<std::uint32_t>(std::min<size_t>(images.size(), 6)))]);
    made.outputs.assign(wanted.begin(), wanted.end());

    // The document lists the passes in random order.
    std::vector<std::string> listed = made.names;
    std::shuffle(listed.begin(), listed.end(), random);
    for (const std::string& name : listed) {
        const Behaviour& how = made.passes.at(name);
        const PortKind kind = buffers ? PortKind::Buffer : PortKind::Texture;
        const PortKind scratch =
            how.scratch.kind == ResourceKind::Buffer ? PortKind::Buffer : PortKind::Texture;
        made.registry.add(
            mockType("T" + name,
                     {opt("in0", kind), opt("in1", kind), opt("in2", kind), opt("base", kind),
                      opt("m", PortKind::Tracer), out("out0", kind), out("out1", kind), out("updated", kind),
                      internal("scratch", scratch), out("tracer", PortKind::Tracer)},
                     [how](const World&, const Inputs& in, const Demand& demand) {
                         return declareRandom(how, in, demand);
                     }));
        GraphPass pass;
        pass.name = name;
        pass.type = "T" + name;
        made.graph.passes.push_back(pass);
        for (const auto& [port, from] : how.feeds) made.graph.edges.push_back({from, {name, port}, {}});
    }
    for (const PortRef& port : made.outputs) made.graph.outputs.push_back({port, {}});
    return made;
}

// What every port holds in a frame, by the graph alone: everything is computed anew in every frame.
class Interpreter {
public:
    explicit Interpreter(const RandomGraph& graph)
        : graph_(graph) {}

    void frame(Token frame, Token lights) {
        previous_ = std::move(values_);
        values_.clear();
        for (const std::string& name : graph_.names) evaluate(name, frame, lights);
    }
    [[nodiscard]] Token at(const std::string& pass, const std::string& port) const {
        const Behaviour& how = graph_.passes.at(pass);
        const auto feed = how.feeds.find(port);
        return feed == how.feeds.end() ? values_.at({pass, port}) : values_.at(feed->second);
    }
    [[nodiscard]] Token previousAt(const std::string& pass, const std::string& port) const {
        const auto found = previous_.find({pass, port});
        return found == previous_.end() ? 0 : found->second;
    }
    // What a binding of the module behind `input` of `pass` reads: "m_scratch" leads to the provider's
    // scratch.
    [[nodiscard]] Token through(const std::string& pass, const std::string& name) const {
        if (!name.starts_with("m_")) return at(pass, name);
        return through(graph_.passes.at(pass).feeds.at("m").pass, name.substr(2));
    }

    // Which ports somebody asks for decides what a declaration reads (see declareRandom).
    std::set<std::string> tracerDemanded;
    std::set<PortRef> demanded;

private:
    // The module's value: all that a consumer reads through it.
    [[nodiscard]] Token moduleToken(const std::string& provider) const {
        const Behaviour& how = graph_.passes.at(provider);
        Token token = values_.at({provider, "scratch"});
        if (how.fed("in1")) token += at(provider, "in1");
        if (how.fed("m")) token += moduleToken(how.feeds.at("m").pass);
        return token;
    }
    void evaluate(const std::string& name, Token frame, Token lights) {
        const Behaviour& how = graph_.passes.at(name);
        const Token own = how.depends == Causes::Frame ? frame : how.depends == Causes::Lights ? lights : 0;
        // The order of reads does not matter: sums.
        Token first = own;
        if (how.fed("in0")) first += at(name, "in0");
        values_[{name, "scratch"}] = mix(first, hashOf(name + "first" + "scratch"));
        Token all = own;
        for (const std::string& port : textureInputs)
            if (how.fed(port)) all += at(name, port);
        if (how.fed("m")) all += moduleToken(how.feeds.at("m").pass);
        const bool scratch = how.twoSteps || (how.providesModule && tracerDemanded.contains(name));
        if (scratch) all += values_[{name, "scratch"}];
        if (how.history && demanded.contains({name, "out0"})) all += previousAt(name, "out0");
        values_[{name, "out0"}] = mix(all, hashOf(name + "last" + "out0"));
        values_[{name, "out1"}] = how.sameOut1 && how.fed("in0") ? at(name, "in0")
                                  : how.constantOut1             ? Token{3}
                                                                 : mix(all, hashOf(name + "last" + "out1"));
        if (how.fed("base"))
            values_[{name, "updated"}] = mix(all + at(name, "base"), hashOf(name + "last" + "updated"));
    }

    const RandomGraph& graph_;
    std::map<PortRef, Token> values_, previous_;
};

// Executes a plan as the executor does: barrier, copies, clears, step; and checks every access.
class Device {
public:
    Device(const Plan& plan, const RandomGraph& graph, Interpreter& expected)
        : plan_(plan)
        , graph_(graph)
        , expected_(expected)
        , swapped_(plan.resources.size(), false) {
        for (size_t i = 0; i < plan.resources.size(); ++i)
            if (plan.resources[i].constant) store(blocks(static_cast<int>(i), false), 3);
    }

    void frame(Causes causes, Token frame, Token lights) {
        std::vector<Causes> raised(plan_.passes.size(), Causes::None);
        for (size_t i = 0; i < plan_.passes.size(); ++i) {
            const PlanPass& pass = plan_.passes[i];
            raised[i] = pass.depends & causes;
            for (const int input : pass.inputs) raised[i] |= raised[static_cast<size_t>(input)];
            if (!any(raised[i]) && !pass.always && frame > 1) {
                EXPECT_FALSE(pass.everyFrame);
                continue;
            }
            if (!any(raised[i])) raised[i] = Causes::Frame; // as the executor does for what always runs
            run(pass, frame, lights);
        }
        for (const PlanOutput& output : plan_.outputs)
            EXPECT_TRUE(
                holds(blocks(output.resource, false), expected_.at(output.port.pass, output.port.port)))
                << output.port.text();
    }

    int mistakes = 0;

private:
    // A texture is one block, a buffer one for every 256 bytes.
    struct Block {
        Token content = 0;
        std::uint64_t lastWrite = 0, lastAccess = 0; // on the clock
        int object = 0;
    };
    using Blocks = std::vector<Block*>;
    [[nodiscard]] Blocks blocks(int index, bool previous) {
        const PlanResource& resource = plan_.resources[static_cast<size_t>(index)];
        const bool second = resource.history && (previous != swapped_[static_cast<size_t>(index)]);
        const int object = resource.object + (second ? 1 : 0);
        const bool buffer = resource.desc.kind == ResourceKind::Buffer;
        const std::uint64_t first = resource.offset / 256, count = buffer ? resource.desc.bytes / 256 : 1;
        EXPECT_LE(resource.offset + resource.desc.totalBytes(),
                  plan_.objects[static_cast<size_t>(object)].desc.totalBytes());
        Blocks found;
        for (std::uint64_t i = first; i < first + count; ++i) {
            found.push_back(&blocks_[{object, i}]);
            found.back()->object = object;
        }
        return found;
    }
    static void store(const Blocks& blocks, Token content) {
        for (Block* block : blocks) block->content = content;
    }
    [[nodiscard]] static bool holds(const Blocks& blocks, Token content) {
        return std::all_of(blocks.begin(), blocks.end(),
                           [&](const Block* block) { return block->content == content; });
    }

    void run(const PlanPass& pass, Token frame, Token lights) {
        for (size_t i = 0; i < plan_.resources.size(); ++i)
            if (plan_.resources[i].history && plan_.resources[i].port.pass == pass.name)
                swapped_[i] = !swapped_[i];
        for (int i = 0; i < pass.stepCount; ++i) runStep(pass, pass.firstStep + i, frame, lights);
    }

    void runStep(const PlanPass& pass, int index, Token frame, Token lights) {
        const PlanStep& step = plan_.steps[static_cast<size_t>(index)];
        for (std::uint32_t bit = 0; bit < 8; ++bit)
            if ((static_cast<std::uint32_t>(step.barrier) & (1U << bit)) != 0) barrierAt_[bit] = ++clock_;
        for (const auto& [from, to] : step.copies) {
            access(blocks(from, false), Access::Copy, false);
            access(blocks(to, false), Access::Copy, true);
            const Blocks source = blocks(from, false), target = blocks(to, false);
            ASSERT_EQ(source.size(), target.size());
            for (size_t i = 0; i < source.size(); ++i) target[i]->content = source[i]->content;
        }
        if (index == pass.firstStep)
            for (size_t i = 0; i < plan_.resources.size(); ++i)
                if (plan_.resources[i].clear && plan_.resources[i].port.pass == pass.name) {
                    const Blocks cleared = blocks(static_cast<int>(i), false);
                    access(cleared, Access::Copy, true);
                    store(cleared, 7);
                }
        const Behaviour& how = graph_.passes.at(pass.name);
        Token sum = how.depends == Causes::Frame ? frame : how.depends == Causes::Lights ? lights : 0;
        for (const PlanBinding& binding : step.bindings) {
            const Blocks at = blocks(binding.resource, binding.previous);
            access(at, binding.access, binding.write);
            if (binding.write) continue;
            const Token wanted = binding.previous ? expected_.previousAt(pass.name, binding.port)
                                                  : expected_.through(pass.name, binding.name);
            if (!holds(at, wanted)) {
                ++mistakes;
                ADD_FAILURE() << "frame " << frame << ": " << pass.name << " reads the wrong content by '"
                              << binding.name << "'";
            }
            sum += at[0]->content;
        }
        for (const PlanBinding& binding : step.bindings) {
            if (!binding.write) continue;
            // An update depends on what is there; everything else is written wholly.
            for (Block* block : blocks(binding.resource, false))
                block->content = mix(sum + (binding.port == "updated" ? block->content : 0),
                                     hashOf(pass.name + step.step.name + binding.port));
        }
    }

    [[nodiscard]] std::uint64_t lastBarrier(Access access) const {
        for (std::uint32_t bit = 0; bit < 8; ++bit)
            if (static_cast<std::uint32_t>(barrierFor(access)) == 1U << bit) return barrierAt_[bit];
        return 0;
    }

    void access(const Blocks& at, Access kind, bool write) {
        for (Block* block : at) access(*block, kind, write);
    }
    void access(Block& block, Access access, bool write) {
        const bool incoherent = write && isIncoherent(access);
        const std::string& label = plan_.objects[static_cast<size_t>(block.object)].label;
        if (block.lastWrite > 0 && lastBarrier(access) < block.lastWrite) {
            ++mistakes;
            ADD_FAILURE() << "no " << accessName(access) << " barrier since a shader wrote " << label;
        }
        if (incoherent && block.lastAccess > 0 && lastBarrier(access) < block.lastAccess) {
            ++mistakes;
            ADD_FAILURE() << "a store overtakes an access of " << label;
        }
        if (incoherent) block.lastWrite = ++clock_;
        if (access != Access::Copy && access != Access::Host) block.lastAccess = ++clock_;
    }

    const Plan& plan_;
    const RandomGraph& graph_;
    Interpreter& expected_;
    std::map<std::pair<int, std::uint64_t>, Block> blocks_; // by object and number in it
    std::array<std::uint64_t, 8> barrierAt_{};
    std::uint64_t clock_ = 0;
    std::vector<bool> swapped_; // history: the second object is the present one
};

void replay(std::uint32_t seed, bool share, bool keepAll) {
    SCOPED_TRACE(testing::Message() << "seed " << seed << (share ? " shared" : " unshared")
                                    << (keepAll ? " keep-all" : ""));
    const RandomGraph graph = makeGraph(seed);
    World world;
    world.facts.lightsMove = true;
    CompileOptions options;
    options.shareMemory = share;
    options.keepAll = keepAll;
    const Plan plan =
        compile(graph.graph, graph.registry, makePasses(graph.graph, graph.registry), world, options);

    Interpreter expected(graph);
    for (const PlanPass& pass : plan.passes) {
        if (pass.descs.contains("tracer")) expected.tracerDemanded.insert(pass.name);
        if (pass.descs.contains("out0")) expected.demanded.insert({pass.name, "out0"});
    }
    Device device(plan, graph, expected);
    std::mt19937 random(seed + 1);
    Token lights = 100;
    for (Token frame = 1; frame <= 6 && device.mistakes == 0 && !testing::Test::HasFailure(); ++frame) {
        Causes causes = Causes::Frame;
        if (random() % 3 == 0) {
            ++lights;
            causes |= Causes::Lights;
        }
        expected.frame(frame, lights);
        device.frame(causes, frame, lights);
    }
}

TEST(Replay, EveryReaderSeesWhatItsProducerMakes) {
    for (std::uint32_t seed = 0; seed < 1500 && !HasFailure(); ++seed) replay(seed, true, false);
}
TEST(Replay, WithoutSharing) {
    for (std::uint32_t seed = 0; seed < 300 && !HasFailure(); ++seed) replay(seed, false, false);
}
TEST(Replay, WithNothingLeftOut) {
    for (std::uint32_t seed = 0; seed < 300 && !HasFailure(); ++seed) replay(seed, true, true);
}

} // namespace
} // namespace kestrel
