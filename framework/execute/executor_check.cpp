// What is looked at after passes and frames: loops that gave up, and values that no output should hold.
#include "execute/executor.h"
#include "execute/finite.h"
#include "gl/loader.h"
#include "shader/iterations.h"
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace kestrel {

namespace {

bool holdsFloats(const Desc& desc) { return desc.format != Format::None && !formatInfo(desc.format).integer; }

// A buffer's texels, as one row of pixels.
std::optional<BadValue> firstBadOfBuffer(const gl::Buffer& buffer, const Desc& desc, double minimum,
                                         double maximum) {
    const FormatInfo& format = formatInfo(desc.format);
    if (format.bytes != 4 * format.channels) return std::nullopt;
    const std::vector<std::byte> bytes = buffer.download();
    const auto elements = static_cast<int>(std::min<std::uint64_t>(bytes.size() / 4, maxImageValues));
    Image image(elements / format.channels, 1, format.channels);
    std::memcpy(image.values.data(), bytes.data(), image.values.size() * sizeof(float));
    return firstBadValue(image, minimum, maximum);
}

} // namespace

void Executor::checkIterations() {
    if (iterations_.bytes() == 0) return;
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    const std::vector<std::byte> bytes = iterations_.download();
    std::vector<Problem> problems;
    for (size_t i = 0; i < plan().steps.size(); ++i) {
        IterationsBlock block;
        std::memcpy(&block, bytes.data() + i * static_cast<size_t>(iterationsStride), sizeof(block));
        if (block.exhausted == 0) continue;
        problems.push_back(
            {{},
             fmt::format("{}: the loops of {} invocations made more than {} iterations (the most: {})",
                         labels_[i], block.exhausted, maxIterations, block.maximum)});
    }
    if (!problems.empty()) throw Error(ExitStatus::MeasureFailed, std::move(problems));
}

void Executor::checkOutputs(const PlanPass& pass) {
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    const PassType* type = registry != nullptr ? registry->find(pass.type) : nullptr;
    for (const auto& [port, resource] : pass.ports) {
        const PortInfo* info = type != nullptr ? type->port(port) : nullptr;
        if (resource < 0 || (info != nullptr && info->direction == PortDirection::Input)) continue;
        const Desc& desc = resources_.info(resource).desc;
        if (!holdsFloats(desc)) continue;
        const double minimum = info != nullptr ? info->minimum : -HUGE_VAL;
        const double maximum = info != nullptr ? info->maximum : HUGE_VAL;
        BadOutput bad{pass.name, port, -1, resources_.isBuffer(resource), {}};
        const auto note = [&](const std::optional<BadValue>& first) {
            if (!first) return;
            const std::uint64_t before = bad.first.count;
            if (before == 0) bad.first = *first;
            bad.first.count = before + first->count;
        };
        if (bad.buffer) {
            note(firstBadOfBuffer(resources_.buffer(resource), desc, minimum, maximum));
        } else {
            const int layers =
                desc.kind == ResourceKind::TextureCube ? 6 : static_cast<int>(desc.extent.depth);
            for (int layer = 0; layer < layers; ++layer) {
                if (layers > 1 && bad.first.count == 0) bad.layer = layer;
                const Image image = resources_.texture(resource).downloadImage(layer);
                note(firstBadValue(image, minimum, maximum));
                if (report_.look) report_.look({pass.name, port}, image);
            }
        }
        if (bad.first.count > 0) report_.bad.push_back(std::move(bad));
    }
}

} // namespace kestrel
