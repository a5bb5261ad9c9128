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
        throw MachineError(fmt::format("{}: {}, {}, is beyond the device's limit of {}", resource.port.text(),
                                       what, need, limit));
    };
    if (desc.kind == ResourceKind::Buffer) {
        // Each use is held against its own limit where it is declared: a block's bytes, or texels. Here what
        // is beyond both.
        const auto mostBytes = static_cast<std::uint64_t>(capabilities.maxStorageBlockBytes);
        const auto mostTexels = static_cast<std::uint64_t>(capabilities.maxTextureBufferTexels);
        if (desc.bytes <= mostBytes) return;
        if (desc.format == Format::None) refuse("a buffer's size in bytes", desc.bytes, mostBytes);
        const std::uint64_t texels = desc.bytes / static_cast<std::uint64_t>(formatInfo(desc.format).bytes);
        if (texels > mostTexels) refuse("a buffer's size in texels", texels, mostTexels);
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
        objects.at(first).content.push_back(fmt::format("{} at {}", resource.port.text(), resource.offset));
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
        Entry& entry = entries.emplace_back();
        entry.plan = resource;
        if (resource.object < 0) continue;
        const auto first = static_cast<size_t>(resource.object);
        entry.kept = kept[first] && (!resource.history || kept[first + 1]);
        for (const Entry& old : entries_)
            if (entry.kept && old.plan.port == resource.port) entry.flipped = old.flipped;
        const bool whole = objects[first].desc.bytes == resource.desc.bytes;
        if (resource.desc.kind == ResourceKind::Buffer && !whole)
            entry.range = objects[first].buffer.range(resource.offset, resource.desc.bytes);
    }
    entries_ = std::move(entries);
    objects_ = std::move(objects);
    fillNew();
}

void Resources::fillNew() {
    for (int i = 0; i < static_cast<int>(entries_.size()); ++i) {
        const auto& [plan, flipped, kept, range] = entries_[static_cast<size_t>(i)];
        // A constant may have another value under the new plan.
        if (plan.object < 0 || (kept && !plan.constant)) continue;
        const glm::vec4 value = plan.constant.value_or(plan.clear.value_or(glm::vec4(0)));
        fill(i, false, value);
        if (plan.history) fill(i, true, value);
    }
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
    Entry& entry = entries_.at(static_cast<size_t>(resource));
    return entry.range ? entry.range : object(resource, previous).buffer;
}

void Resources::swapHistory(int resource) {
    Entry& entry = entries_.at(static_cast<size_t>(resource));
    if (entry.plan.history) entry.flipped = !entry.flipped;
}

void Resources::fill(int resource, bool previous, const glm::vec4& value) {
    if (isBuffer(resource))
        buffer(resource, previous).clear(clearWord(info(resource).desc, value));
    else
        texture(resource, previous).clear(value);
}

void Resources::fill(int resource, const glm::vec4& value) { fill(resource, false, value); }

void Resources::copy(int from, int to) {
    if (isBuffer(from))
        gl::copyResource(buffer(from), buffer(to));
    else
        gl::copyResource(texture(from), texture(to));
}

} // namespace kestrel
