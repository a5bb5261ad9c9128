#include "graph/memory.h"
#include <algorithm>
#include <array>
#include <functional>
#include <numeric>

namespace kestrel {
namespace {

int addObject(Plan& plan, const Desc& desc, std::string label) {
    plan.objects.push_back({desc, std::move(label)});
    return static_cast<int>(plan.objects.size()) - 1;
}

std::uint64_t alignedUp(std::uint64_t bytes) {
    return (bytes + rangeAlignment - 1) / rangeAlignment * rangeAlignment;
}

bool meet(const Lifetime& a, const Lifetime& b) { return a.first <= b.last && b.first <= a.last; }

using ComesBefore = std::function<bool(const Lifetime&, const Lifetime&)>;

// One lifetime after the other, each in a gap that those placed before leave for as long as it lives.
Packing placeInOrder(const std::vector<Lifetime>& lifetimes, const ComesBefore& before, bool tightest) {
    std::vector<size_t> order(lifetimes.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return before(lifetimes[a], lifetimes[b]); });
    Packing packing;
    packing.offsets.resize(lifetimes.size());
    std::vector<size_t> placed; // sorted by offset
    for (const size_t i : order) {
        const std::uint64_t need = alignedUp(lifetimes[i].bytes);
        constexpr std::uint64_t none = UINT64_MAX;
        std::uint64_t end = 0, chosen = none, chosenGap = none;
        for (const size_t other : placed) {
            if (!meet(lifetimes[i], lifetimes[other])) continue;
            const std::uint64_t begin = packing.offsets[other];
            const std::uint64_t gap = begin > end ? begin - end : 0;
            if (gap >= need && (tightest ? gap < chosenGap : chosen == none)) {
                chosen = end;
                chosenGap = gap;
            }
            end = std::max(end, begin + alignedUp(lifetimes[other].bytes));
        }
        packing.offsets[i] = chosen == none ? end : chosen;
        packing.bytes = std::max(packing.bytes, packing.offsets[i] + lifetimes[i].bytes);
        const auto place = std::upper_bound(
            placed.begin(), placed.end(), packing.offsets[i],
            [&](std::uint64_t offset, size_t other) { return offset < packing.offsets[other]; });
        placed.insert(place, i);
    }
    return packing;
}

// Puts the transient buffers into one object by ranges, if that saves anything.
void placeBuffers(Plan& plan) {
    std::vector<PlanResource*> buffers;
    std::vector<Lifetime> lifetimes;
    std::uint64_t alone = 0;
    for (PlanResource& resource : plan.resources) {
        if (!resource.transient || resource.desc.kind != ResourceKind::Buffer) continue;
        // A smaller one would fill less than the place that it takes.
        if (resource.desc.bytes < rangeAlignment) continue;
        buffers.push_back(&resource);
        lifetimes.push_back({resource.firstStep, resource.lastStep, resource.desc.bytes});
        alone += resource.desc.bytes;
    }
    const Packing packing = packLifetimes(lifetimes);
    if (packing.bytes >= alone) return;
    std::string label;
    for (const PlanResource* buffer : buffers) label += (label.empty() ? "" : ", ") + buffer->port.text();
    const int object = addObject(plan, Desc::buffer(packing.bytes), label);
    for (size_t i = 0; i < buffers.size(); ++i) {
        buffers[i]->object = object;
        buffers[i]->offset = packing.offsets[i];
    }
    plan.memory.unshared += alone;
    plan.memory.transient += packing.bytes;
}

} // namespace

bool sameStorage(const Desc& a, const Desc& b) {
    return a.kind == b.kind && a.format == b.format && a.extent == b.extent && a.mips == b.mips &&
           a.bytes == b.bytes;
}

std::uint64_t peakBytes(const std::vector<Lifetime>& lifetimes) {
    std::uint64_t peak = 0;
    // The most live where one begins.
    for (const Lifetime& at : lifetimes) {
        std::uint64_t live = 0;
        for (const Lifetime& other : lifetimes)
            if (other.first <= at.first && at.first <= other.last) live += other.bytes;
        peak = std::max(peak, live);
    }
    return peak;
}

Packing packLifetimes(const std::vector<Lifetime>& lifetimes) {
    const auto length = [](const Lifetime& a) { return a.last - a.first; };
    const std::array<ComesBefore, 3> orders = {
        [](const Lifetime& a, const Lifetime& b) { return a.bytes > b.bytes; },
        [&](const Lifetime& a, const Lifetime& b) { return length(a) > length(b); },
        [](const Lifetime& a, const Lifetime& b) { return a.first < b.first; },
    };
    Packing best = placeInOrder(lifetimes, orders[0], false);
    for (const ComesBefore& order : orders)
        for (const bool tightest : {false, true})
            if (Packing packing = placeInOrder(lifetimes, order, tightest); packing.bytes < best.bytes)
                best = std::move(packing);
    return best;
}

void assignObjects(Plan& plan, bool shareMemory) {
    plan.memory = {};
    if (shareMemory) placeBuffers(plan);
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
        if (resource.object >= 0) continue;
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
