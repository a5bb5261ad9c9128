// The headers of an EXR, read by OpenEXR after a look at what they promise: it would set aside memory for it.
#pragma once
#include <OpenEXR/ImfHeader.h>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace kestrel::detail {

// One header a part. Throws InputError whose location is `name` for a file that is cut off or damaged, of a
// version or compression that is not read, or whose windows, tiles or channels are beyond the limits of
// image.h and of this file.
std::vector<Imf::Header> readExrHeaders(std::span<const std::byte> bytes, const std::string& name);

bool isDeep(const Imf::Header& header);

// The sentence for what OpenEXR threw: in one line, without the library's names for the file.
std::string exrReason(const std::exception& problem);

} // namespace kestrel::detail
