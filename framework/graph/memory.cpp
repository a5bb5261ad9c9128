#include "graph/memory.h"
#include <algorithm>
#include <numeric>

namespace kestrel {
namespace {

int addObject(Plan& plan, const Desc& desc, std::string label) {
    plan.objects.push_back({desc, std::move(label)});
    return static_cast<int>(plan.objects.size()) - 1;
}

} // namespace

bool sameStorage(const Desc& a, const Desc& b) {
    return a.kind == b.kind && a.format == b.format && a.extent == b.extent && a.mips == b.mips &&
           a.bytes == b.bytes;
}

void assignObjects(Plan& plan, bool shareMemory) {
    plan.memory = {};
    std::vector<size_t> byBegin(plan.resources.size());
    std::iota(byBegin.begin(), byBegin.end(), size_t{0});
    std::stable_sort(byBegin.begin(), byBegin.end(), [&](size_t a, size_t b) {
        return plan.resources[a].firstStep < plan.resources[b].firstStep;
    });
    struct Shared {
        int object;
        int busyUntil; // last step that touches what it holds at present
    };
    std::vector<Shared> pool;
    for (const size_t i : byBegin) {
        PlanResource& resource = plan.resources[i];
        const std::uint64_t bytes = resource.desc.totalBytes();
        if (!resource.transient) {
            resource.object = addObject(plan, resource.desc, resource.port.text());
            if (resource.history) addObject(plan, resource.desc, resource.port.text() + " (last frame)");
            plan.memory.persistent += resource.history ? 2 * bytes : bytes;
            continue;
        }
        plan.memory.unshared += bytes;
        const auto free = std::find_if(pool.begin(), pool.end(), [&](const Shared& shared) {
            return shareMemory && shared.busyUntil < resource.firstStep &&
                   sameStorage(plan.objects[static_cast<size_t>(shared.object)].desc, resource.desc);
        });
        if (free == pool.end()) {
            resource.object = addObject(plan, resource.desc, resource.port.text());
            pool.push_back({resource.object, resource.lastStep});
            plan.memory.transient += bytes;
        } else {
            resource.object = free->object;
            free->busyUntil = resource.lastStep;
            plan.objects[static_cast<size_t>(free->object)].label += ", " + resource.port.text();
        }
    }
}

} // namespace kestrel
