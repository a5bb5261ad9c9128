// Attribute streams of KHR_meshopt_compression, version 1, for tests: by the extension's appendix A, with
// every way of storing that it has in turn.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace kestrel::test {

class MeshoptEncoder {
public:
    // `stride` bytes an element, `channels` one of 0, 1, 2 | rotation << 4 for each four of them.
    static std::vector<std::uint8_t> encode(std::span<const std::uint8_t> elements, size_t stride,
                                            const std::vector<std::uint8_t>& channels) {
        MeshoptEncoder encoder(stride, channels);
        const size_t count = elements.size() / stride;
        const size_t most = std::min(8192 / stride & ~size_t{15}, size_t{256});
        std::vector<std::uint8_t> before(elements.begin(),
                                         elements.begin() + static_cast<std::ptrdiff_t>(stride));
        const std::vector<std::uint8_t> baseline = before;
        for (size_t first = 0; first < count; first += most) {
            const size_t here = std::min(most, count - first);
            encoder.addBlock(elements.subspan(first * stride, here * stride), before);
        }
        const size_t tail = stride + stride / 4;
        encoder.out_.resize(encoder.out_.size() + (tail < 24 ? 24 - tail : 0), 0);
        encoder.out_.insert(encoder.out_.end(), baseline.begin(), baseline.end());
        encoder.out_.insert(encoder.out_.end(), channels.begin(), channels.end());
        return encoder.out_;
    }

private:
    MeshoptEncoder(size_t stride, const std::vector<std::uint8_t>& channels)
        : stride_(stride)
        , channels_(channels) {}

    template<class Word>
    static Word zigzag(Word v) {
        constexpr Word sign = static_cast<Word>(Word{1} << (8 * sizeof(Word) - 1));
        return static_cast<Word>((v & sign) != 0 ? ~(v << 1) : v << 1);
    }

    static std::uint32_t delta(unsigned int channel, std::uint32_t value, std::uint32_t before) {
        if ((channel & 15U) == 2) return std::rotl(value ^ before, static_cast<int>(channel >> 4));
        std::uint32_t result = 0;
        if (channel == 1)
            for (unsigned int shift = 0; shift < 32; shift += 16)
                result |= static_cast<std::uint32_t>(
                              zigzag(static_cast<std::uint16_t>((value >> shift) - (before >> shift))))
                          << shift;
        else
            for (unsigned int shift = 0; shift < 32; shift += 8)
                result |= static_cast<std::uint32_t>(
                              zigzag(static_cast<std::uint8_t>((value >> shift) - (before >> shift))))
                          << shift;
        return result;
    }

    void addBlock(std::span<const std::uint8_t> elements, std::vector<std::uint8_t>& before) {
        const size_t count = elements.size() / stride_;
        std::vector<std::vector<std::uint8_t>> bytes(stride_, std::vector<std::uint8_t>(count));
        for (size_t i = 0; i < count; ++i)
            for (size_t word = 0; word < stride_ / 4; ++word) {
                std::uint32_t value = 0, last = 0;
                std::memcpy(&value, elements.data() + i * stride_ + 4 * word, 4);
                std::memcpy(&last, before.data() + 4 * word, 4);
                const std::uint32_t d = delta(channels_[word], value, last);
                for (size_t k = 0; k < 4; ++k)
                    bytes[4 * word + k][i] = static_cast<std::uint8_t>(d >> (8 * k));
                std::memcpy(before.data() + 4 * word, &value, 4);
            }
        std::vector<std::uint8_t> controls(stride_ / 4, 0), data;
        for (size_t k = 0; k < stride_; ++k) {
            const unsigned int control = controlOf(bytes[k]);
            controls[k / 4] = static_cast<std::uint8_t>(controls[k / 4] | control << (2 * (k % 4)));
            addBytes(control, bytes[k], data);
        }
        out_.insert(out_.end(), controls.begin(), controls.end());
        out_.insert(out_.end(), data.begin(), data.end());
    }

    unsigned int controlOf(const std::vector<std::uint8_t>& deltas) {
        if (std::all_of(deltas.begin(), deltas.end(), [](std::uint8_t d) { return d == 0; })) return 2;
        constexpr unsigned int turns[] = {0, 1, 3};
        return turns[turn_++ % 3];
    }

    static std::vector<std::uint8_t> group(unsigned int bits, const std::uint8_t* deltas) {
        std::vector<std::uint8_t> packed(16 * bits / 8, 0), whole;
        const unsigned int each = bits == 0 ? 1 : 8 / bits, sentinel = (1U << bits) - 1;
        for (unsigned int i = 0; i < 16 && bits != 0; ++i) {
            const unsigned int value = bits == 8 ? deltas[i] : std::min<unsigned int>(deltas[i], sentinel);
            const unsigned int shift = bits == 1 ? i % each : bits * (each - 1 - i % each);
            packed[i / each] = static_cast<std::uint8_t>(packed[i / each] | value << shift);
            if (bits != 8 && value == sentinel) whole.push_back(deltas[i]);
        }
        packed.insert(packed.end(), whole.begin(), whole.end());
        return packed;
    }

    static void addBytes(unsigned int control, std::vector<std::uint8_t> deltas,
                         std::vector<std::uint8_t>& data) {
        if (control == 2) return;
        if (control == 3) {
            data.insert(data.end(), deltas.begin(), deltas.end());
            return;
        }
        constexpr unsigned int widths[2][4] = {{0, 1, 2, 4}, {1, 2, 4, 8}};
        deltas.resize((deltas.size() + 15) / 16 * 16, 0);
        const size_t groups = deltas.size() / 16;
        std::vector<std::uint8_t> headers((groups + 3) / 4, 0), blocks;
        for (size_t g = 0; g < groups; ++g) {
            const std::uint8_t* first = deltas.data() + 16 * g;
            const bool isZero = std::all_of(first, first + 16, [](std::uint8_t d) { return d == 0; });
            std::vector<std::uint8_t> best;
            unsigned int chosen = 0;
            for (unsigned int mode = 0; mode < 4; ++mode) {
                if (widths[control][mode] == 0 && !isZero) continue;
                std::vector<std::uint8_t> coded = group(widths[control][mode], first);
                if ((mode > 0 && !best.empty() && coded.size() >= best.size()) || (isZero && mode > 0))
                    continue;
                best = std::move(coded);
                chosen = mode;
            }
            headers[g / 4] = static_cast<std::uint8_t>(headers[g / 4] | chosen << (2 * (g % 4)));
            blocks.insert(blocks.end(), best.begin(), best.end());
        }
        data.insert(data.end(), headers.begin(), headers.end());
        data.insert(data.end(), blocks.begin(), blocks.end());
    }

    size_t stride_;
    std::vector<std::uint8_t> channels_, out_ = {0xA1};
    unsigned int turn_ = 0;
};

} // namespace kestrel::test
