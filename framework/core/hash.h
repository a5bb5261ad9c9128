// A hash for names of files and for telling contents apart; not against those who want two to be equal.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace kestrel {

// FNV-1a of 64 bits (Fowler, Noll, Vo) over what is added.
class Fnv1a {
public:
    static constexpr std::uint64_t start = 0xcbf29ce484222325u;
    explicit Fnv1a(std::uint64_t seed = start)
        : value_(seed) {}
    void add(std::span<const std::byte> bytes) {
        for (const std::byte byte : bytes)
            value_ = (value_ ^ std::to_integer<std::uint64_t>(byte)) * 0x100000001b3u;
    }
    void add(std::string_view text) { add(std::as_bytes(std::span(text))); }
    [[nodiscard]] std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_;
};

} // namespace kestrel
