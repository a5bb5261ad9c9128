// What every page of results is made of: one file without outside links.
#pragma once
#include <string>
#include <string_view>

namespace kestrel::page {

extern const std::string_view style; // CSS

// Text as it may stand in an element or an attribute.
std::string htmlText(std::string_view text);
// A whole page: its head with the title and the style, `more` style, and the body.
std::string document(std::string_view title, std::string_view more, std::string_view body);

} // namespace kestrel::page
