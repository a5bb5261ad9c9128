// What the fuzz targets share. A target reads any bytes as one kind of file: what it may do with them is read
// them or throw an InputError; everything else (another exception, a failed check, what a sanitizer sees,
// more time or memory than fuzz.sh allows) ends the run.
#pragma once
#include "core/check.h"
#include "core/error.h"
#include "core/files.h"
#include "core/log.h"
#include "support/temporary_folder.h"
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace kestrel::fuzz {

// Whether `read` took the input. A refusal must be lines that can be read: one a problem, without control
// characters.
template<class Read>
bool taken(const Read& read) {
    setLogLevel(LogLevel::Off);
    try {
        read();
        return true;
    } catch (const InputError& error) {
        KESTREL_CHECK(!error.problems().empty());
        for (const Problem& problem : error.problems()) {
            const std::string text = problem.text();
            KESTREL_CHECK(!problem.message.empty());
            for (const char letter : text)
                KESTREL_CHECK(std::iscntrl(static_cast<unsigned char>(letter)) == 0);
        }
        return false;
    }
}

inline std::string_view textOf(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}
inline std::span<const std::byte> bytesOf(const std::uint8_t* data, std::size_t size) {
    return std::as_bytes(std::span(data, size));
}

// A folder of this process, with the file that is written anew for each input.
inline const test::TemporaryFolder& folder() {
    static const test::TemporaryFolder made;
    return made;
}

} // namespace kestrel::fuzz
