#include "scene/meshopt_attributes.h"
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

namespace kestrel {
namespace {

constexpr size_t groupSize = 16, largestBlock = 256, largestStride = 256;
constexpr size_t smallestTail = 24;

// Reads from the front; `take` gives nullptr where too little is left.
class Stream {
public:
    explicit Stream(std::span<const std::byte> bytes)
        : rest_(bytes) {}
    const std::uint8_t* take(size_t count) {
        if (count > rest_.size()) return nullptr;
        const auto* taken = reinterpret_cast<const std::uint8_t*>(rest_.data());
        rest_ = rest_.subspan(count);
        return taken;
    }
    [[nodiscard]] bool empty() const { return rest_.empty(); }

private:
    std::span<const std::byte> rest_;
};

// One group of 16 deltas of `bits` (0, 1, 2, 4 or 8) each; all bits set stand for a whole byte behind the
// group.
bool readGroup(Stream& stream, unsigned int bits, std::uint8_t* deltas) {
    if (bits == 0) {
        std::fill_n(deltas, groupSize, std::uint8_t{0});
        return true;
    }
    const std::uint8_t* packed = stream.take(groupSize * bits / 8);
    if (packed == nullptr) return false;
    const unsigned int each = 8 / bits, sentinel = (1U << bits) - 1;
    for (size_t i = 0; i < groupSize; ++i) {
        const auto place = static_cast<unsigned int>(i) % each;
        // Single bits begin with the lowest, wider ones with the highest.
        const unsigned int shift = bits == 1 ? place : bits * (each - 1 - place);
        const unsigned int value = static_cast<unsigned int>(packed[i / each]) >> shift & sentinel;
        deltas[i] = static_cast<std::uint8_t>(value);
        if (bits == 8 || value != sentinel) continue;
        const std::uint8_t* whole = stream.take(1);
        if (whole == nullptr) return false;
        deltas[i] = *whole;
    }
    return true;
}

// The deltas of one byte of `count` elements; `deltas` has room for whole groups.
bool readBytes(Stream& stream, unsigned int control, size_t count, std::uint8_t* deltas) {
    constexpr unsigned int widths[2][4] = {{0, 1, 2, 4}, {1, 2, 4, 8}};
    if (control == 2) {
        std::fill_n(deltas, count, std::uint8_t{0});
        return true;
    }
    if (control == 3) {
        const std::uint8_t* literal = stream.take(count);
        if (literal != nullptr) std::copy_n(literal, count, deltas);
        return literal != nullptr;
    }
    const size_t groups = (count + groupSize - 1) / groupSize;
    const std::uint8_t* headers = stream.take((groups + 3) / 4);
    if (headers == nullptr) return false;
    for (size_t i = 0; i < groups; ++i) {
        const unsigned int mode = static_cast<unsigned int>(headers[i / 4]) >> (2 * (i % 4)) & 3U;
        if (!readGroup(stream, widths[control][mode], deltas + i * groupSize)) return false;
    }
    return true;
}

template<class Word>
Word unzigzag(Word v) {
    return static_cast<Word>((v & 1) != 0 ? ~(v >> 1) : v >> 1);
}

// What four bytes of an element are, from those of the element before and their deltas.
std::uint32_t undone(unsigned int channel, std::uint32_t before, std::uint32_t delta) {
    const unsigned int mode = channel & 15U;
    if (mode == 2) return before ^ std::rotr(delta, static_cast<int>(channel >> 4));
    std::uint32_t result = 0;
    if (mode == 1) {
        for (unsigned int shift = 0; shift < 32; shift += 16) {
            const auto step = unzigzag(static_cast<std::uint16_t>(delta >> shift));
            result |= static_cast<std::uint32_t>(static_cast<std::uint16_t>((before >> shift) + step))
                      << shift;
        }
        return result;
    }
    for (unsigned int shift = 0; shift < 32; shift += 8) {
        const auto step = unzigzag(static_cast<std::uint8_t>(delta >> shift));
        result |= static_cast<std::uint32_t>(static_cast<std::uint8_t>((before >> shift) + step)) << shift;
    }
    return result;
}

bool isChannel(std::uint8_t channel) { return (channel & 15U) < 2 ? channel < 2 : (channel & 15U) == 2; }

// One block of elements. `last` holds the element before, and the last one afterwards.
bool readBlock(Stream& stream, size_t count, size_t stride, const std::uint8_t* channels, std::uint32_t* last,
               std::byte* out) {
    const std::uint8_t* controls = stream.take(stride / 4);
    if (controls == nullptr) return false;
    std::array<std::array<std::uint8_t, largestBlock>, 4> deltas;
    for (size_t word = 0; word < stride / 4; ++word) {
        for (size_t k = 0; k < 4; ++k)
            if (!readBytes(stream, static_cast<unsigned int>(controls[word]) >> (2 * k) & 3U, count,
                           deltas[k].data()))
                return false;
        for (size_t i = 0; i < count; ++i) {
            const std::uint32_t delta = static_cast<std::uint32_t>(deltas[0][i]) |
                                        static_cast<std::uint32_t>(deltas[1][i]) << 8 |
                                        static_cast<std::uint32_t>(deltas[2][i]) << 16 |
                                        static_cast<std::uint32_t>(deltas[3][i]) << 24;
            last[word] = undone(channels[word], last[word], delta);
            std::memcpy(out + i * stride + 4 * word, last + word, 4);
        }
    }
    return true;
}

template<class Component>
void decodeColour(std::byte* element) {
    Component in[4];
    std::memcpy(in, element, sizeof in);
    using Signed = std::make_signed_t<Component>;
    const int y = in[0], co = static_cast<Signed>(in[1]), cg = static_cast<Signed>(in[2]);
    // The highest bit of alpha tells how many bits the components have.
    const auto alpha = static_cast<unsigned int>(in[3]);
    const unsigned int scale = (1U << std::bit_width(alpha)) - 1;
    unsigned int a = alpha & scale >> 1;
    a = a << 1 | (a & 1U);
    constexpr float most = std::numeric_limits<Component>::max();
    const float factor = most / static_cast<float>(std::max(scale, 1U));
    const auto stored = [&](int value) {
        return static_cast<Component>(std::clamp(std::round(static_cast<float>(value) * factor), 0.0f, most));
    };
    const Component out[4] = {stored(y + co - cg), stored(y + cg), stored(y - co - cg),
                              stored(static_cast<int>(a))};
    std::memcpy(element, out, sizeof out);
}

} // namespace

bool isMeshoptAttributes1(std::span<const std::byte> stream) {
    return !stream.empty() && stream[0] == std::byte{0xA1};
}

bool decodeMeshoptAttributes1(std::span<const std::byte> stream, size_t count, size_t stride,
                              std::byte* out) {
    if (stride == 0 || stride % 4 != 0 || stride > largestStride || !isMeshoptAttributes1(stream))
        return false;
    const size_t tail = stride + stride / 4;
    if (stream.size() < 1 + std::max(tail, smallestTail)) return false;
    const std::byte* baseline = stream.data() + stream.size() - tail;
    const auto* channels = reinterpret_cast<const std::uint8_t*>(baseline + stride);
    if (!std::all_of(channels, channels + stride / 4, isChannel)) return false;
    std::array<std::uint32_t, largestStride / 4> last{};
    std::memcpy(last.data(), baseline, stride);
    Stream blocks(stream.subspan(1, stream.size() - 1 - std::max(tail, smallestTail)));
    const size_t most = std::min(8192 / stride & ~(groupSize - 1), largestBlock);
    for (size_t done = 0; done < count;) {
        const size_t here = std::min(most, count - done);
        if (!readBlock(blocks, here, stride, channels, last.data(), out + done * stride)) return false;
        done += here;
    }
    return blocks.empty();
}

void decodeMeshoptColours(std::byte* elements, size_t count, size_t stride) {
    for (size_t i = 0; i < count; ++i)
        if (stride == 4)
            decodeColour<std::uint8_t>(elements + i * stride);
        else
            decodeColour<std::uint16_t>(elements + i * stride);
}

} // namespace kestrel
