// EXR files in memory, as OpenEXR reads and writes them.
#pragma once
#include <OpenEXR/ImfIO.h>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace kestrel::detail {

class ExrInput final : public Imf::IStream {
public:
    explicit ExrInput(std::span<const std::byte> bytes)
        : IStream("")
        , bytes_(bytes) {}
    // Whether someone asked for more bytes than there are: then whatever went wrong, the file is cut off.
    [[nodiscard]] bool ranOut() const { return ranOut_; }

    bool read(char buffer[], int count) override;
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t at) override { at_ = at; }

private:
    std::span<const std::byte> bytes_;
    std::uint64_t at_ = 0;
    bool ranOut_ = false;
};

class ExrOutput final : public Imf::OStream {
public:
    ExrOutput()
        : OStream("") {}
    [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

    void write(const char buffer[], int count) override;
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t at) override { at_ = at; }

private:
    std::vector<std::byte> bytes_;
    std::uint64_t at_ = 0;
};

} // namespace kestrel::detail
