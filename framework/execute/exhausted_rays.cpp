#include "execute/exhausted_rays.h"
#include "core/check.h"
#include "execute/commands.h"
#include <cstring>

namespace kestrel::exhaustion {
namespace {

// The storage block `Exhausted`.
struct ExhaustedRays {
    std::uint32_t rays = 0, exhausted = 0;
    std::uint32_t begun = 0x52414d45; // tells a buffer that counting began with from one that is new
};

} // namespace

void declare(Declaration& declaration, Module& tracer, Step& clears) {
    tracer.defines["COUNT_EXHAUSTED"] = "1";
    tracer.uses.push_back({.port = "exhausted", .access = Access::Storage, .write = true});
    declaration.outputs.push_back(
        {.port = "exhausted", .desc = Desc::buffer(sizeof(ExhaustedRays)), .keeps = true});
    clears.uses.push_back({.port = "exhausted", .access = Access::Copy, .write = true});
    declaration.steps.insert(
        declaration.steps.begin(),
        {.name = "report", .run = report, .uses = {{.port = "exhausted", .access = Access::Host}}});
    declaration.always = true;
}

void clear(Commands& commands) { commands.uploadValue("exhausted", ExhaustedRays{}); }

// What consumers counted since the pass last ran: in the last frame.
void report(Commands& commands) {
    const std::vector<std::byte> bytes = commands.download("exhausted");
    ExhaustedRays counted;
    KESTREL_CHECK_EQ(bytes.size(), sizeof(counted));
    std::memcpy(&counted, bytes.data(), sizeof(counted));
    if (counted.begun != ExhaustedRays{}.begun) return; // a new buffer
    commands.report("rays", counted.rays);
    commands.report("exhausted rays", counted.exhausted);
}

} // namespace kestrel::exhaustion
