// The texts that a page of results is made of.
#pragma once
#include <string_view>

namespace kestrel::page {

extern const std::string_view style;  // CSS
extern const std::string_view script; // JavaScript: draws everything from the JSON in the page

} // namespace kestrel::page
