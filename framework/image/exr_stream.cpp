#include "image/exr_stream.h"
#include <algorithm>
#include <stdexcept>

namespace kestrel::detail {

bool ExrInput::read(char buffer[], int count) {
    const auto wanted = static_cast<std::uint64_t>(std::max(count, 0));
    if (at_ > bytes_.size() || bytes_.size() - at_ < wanted) {
        ranOut_ = true;
        throw std::runtime_error("the file ends");
    }
    const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(at_);
    std::transform(begin, begin + count, buffer, [](std::byte byte) { return static_cast<char>(byte); });
    at_ += wanted;
    return at_ < bytes_.size();
}

void ExrOutput::write(const char buffer[], int count) {
    const auto end = static_cast<std::size_t>(at_) + static_cast<std::size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::transform(buffer, buffer + count, bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                   [](char letter) { return static_cast<std::byte>(letter); });
    at_ = end;
}

} // namespace kestrel::detail
