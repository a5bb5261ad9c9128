// The texts that a page of a sweep is made of, besides page_html.h.
#pragma once
#include <string_view>

namespace kestrel::page {

// JavaScript that draws everything from the JSON in the page, in four parts of one text.
extern const std::string_view plotScript;  // what all of it needs; tool tips and plots
extern const std::string_view splitScript; // the error taken apart
extern const std::string_view tuneScript;  // what `kestrel tune` found (tune/tune_page.cpp)
extern const std::string_view tableScript; // the table, the pictures, and what starts it all

} // namespace kestrel::page
