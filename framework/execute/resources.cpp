#include "execute/resources.h"
#include "core/check.h"
#include <algorithm>
#include <bit>
#include <fmt/format.h>

namespace kestrel {

namespace {

void requireFits(const PlanResource& resource, const Capabilities& capabilities) {
    const Desc& desc = resource.desc;
    const auto refuse = [&](const char* what, std::uint64_t need, std::uint64_t limit) {
        throw MachineError(fmt::format("{}: {} of {} is beyond the device's limit of {}",
                                       resource.port.text(), what, need, limit));
    };
    if (desc.kind == ResourceKind::Buffer) {
        const auto limit = static_cast<std::uint64_t>(capabilities.maxStorageBlockBytes);
        if (desc.bytes > limit) refuse("a buffer of so many bytes", desc.bytes, limit);
        return;
    }
    const auto side = static_cast<std::uint64_t>(
        desc.kind == ResourceKind::Texture3D ? capabilities.max3DTextureSize : capabilities.maxTextureSize);
    const std::uint64_t longest = std::max(desc.extent.width, desc.extent.height);
    if (longest > side) refuse("a texture side", longest, side);
    const auto deep = static_cast<std::uint64_t>(
        desc.kind == ResourceKind::Texture3D ? capabilities.max3DTextureSize : capabilities.maxArrayLayers);
    if (desc.extent.depth > deep) refuse("a texture depth", desc.extent.depth, deep);
}

} // namespace

std::uint32_t clearWord(const Desc& desc, const glm::vec4& value) {
    const FormatInfo& format = formatInfo(desc.format);
    if (desc.format != Format::None && !format.integer) return std::bit_cast<std::uint32_t>(value.x);
    if (value.x < 0) return static_cast<std::uint32_t>(static_cast<std::int32_t>(value.x));
    return value.x >= 4294967295.0F ? ~std::uint32_t{0} : static_cast<std::uint32_t>(value.x);
}

std::vector<Resources::Object> Resources::wantedObjects(const Plan& plan) {
    std::vector<Object> objects(plan.objects.size());
    for (size_t i = 0; i < objects.size(); ++i) objects[i].desc = plan.objects[i].desc;
    for (const PlanResource& resource : plan.resources) {
        if (resource.object < 0) continue;
        const auto first = static_cast<size_t>(resource.object);
        objects.at(first).content.push_back(resource.port.text());
        if (resource.history) objects.at(first + 1).content.push_back(resource.port.text() + " (previous)");
    }
    for (Object& object : objects) std::ranges::sort(object.content);
    return objects;
}

Resources::Object* Resources::takeOver(const Object& wanted, bool sameContent) {
    for (Object& old : objects_)
        if (!old.taken && old.desc == wanted.desc && (!sameContent || old.content == wanted.content))
            return &old;
    return nullptr;
}

void Resources::adopt(const Plan& plan, const Capabilities& capabilities) {
    for (const PlanResource& resource : plan.resources)
        if (resource.object >= 0) requireFits(resource, capabilities);

    std::vector<Object> objects = wantedObjects(plan);
    std::vector<bool> kept(objects.size(), false), made(objects.size(), false);
    const auto move = [&](size_t to, Object& from) {
        from.taken = true;
        objects[to].texture = std::move(from.texture);
        objects[to].buffer = std::move(from.buffer);
        made[to] = true;
    };
    for (size_t i = 0; i < objects.size(); ++i)
        if (Object* old = takeOver(objects[i], true)) {
            move(i, *old);
            kept[i] = true;
        }
    for (size_t i = 0; i < objects.size(); ++i) {
        if (made[i]) continue;
        if (Object* old = takeOver(objects[i], false)) {
            move(i, *old);
            continue;
        }
        const std::string& label = plan.objects[i].label;
        if (objects[i].desc.kind == ResourceKind::Buffer)
            objects[i].buffer = gl::Buffer(std::max<std::uint64_t>(objects[i].desc.bytes, 4), label);
        else
            objects[i].texture = gl::Texture(objects[i].desc, label);
    }

    std::vector<Entry> entries;
    for (const PlanResource& resource : plan.resources) {
        Entry entry{.plan = resource, .flipped = false, .kept = false};
        if (resource.object >= 0) {
            const auto first = static_cast<size_t>(resource.object);
            entry.kept = kept[first] && (!resource.history || kept[first + 1]);
            for (const Entry& old : entries_)
                if (entry.kept && old.plan.port == resource.port) entry.flipped = old.flipped;
            // A constant may have another value under the new plan.
            if (!entry.kept || resource.constant) {
                const glm::vec4 value = resource.constant.value_or(resource.clear.value_or(glm::vec4(0)));
                fill(objects[first], value);
                if (resource.history) fill(objects[first + 1], value);
            }
        }
        entries.push_back(std::move(entry));
    }
    entries_ = std::move(entries);
    objects_ = std::move(objects);
}

bool Resources::isBuffer(int resource) const { return info(resource).desc.kind == ResourceKind::Buffer; }

Resources::Object& Resources::object(int resource, bool previous) {
    const Entry& entry = entries_.at(static_cast<size_t>(resource));
    KESTREL_CHECK_LE(0, entry.plan.object);
    KESTREL_CHECK(!previous || entry.plan.history);
    const bool second = entry.plan.history && (entry.flipped != previous);
    return objects_.at(static_cast<size_t>(entry.plan.object) + (second ? 1 : 0));
}

gl::Texture& Resources::texture(int resource, bool previous) {
    KESTREL_CHECK(!isBuffer(resource));
    return object(resource, previous).texture;
}

gl::Buffer& Resources::buffer(int resource, bool previous) {
    KESTREL_CHECK(isBuffer(resource));
    return object(resource, previous).buffer;
}

void Resources::swapHistory(int resource) {
    Entry& entry = entries_.at(static_cast<size_t>(resource));
    if (entry.plan.history) entry.flipped = !entry.flipped;
}

void Resources::fill(Object& object, const glm::vec4& value) {
    if (object.desc.kind == ResourceKind::Buffer)
        object.buffer.clear(clearWord(object.desc, value));
    else
        object.texture.clear(value);
}

void Resources::fill(int resource, const glm::vec4& value) { fill(object(resource, false), value); }

void Resources::copy(int from, int to) {
    if (isBuffer(from))
        gl::copyResource(buffer(from), buffer(to));
    else
        gl::copyResource(texture(from), texture(to));
}

} // namespace kestrel
