// Numbers and values as JSON text, so that files, messages and reports write them alike.
#pragma once
#include "graph/types.h"
#include <string>

namespace kestrel {

// The shortest text that reads back as the same number; of a number that is exactly a float, as that float
// (0.1 for a float member 0.1f). Whole numbers have no point: "1", "1e+20".
std::string numberText(double number);

// As a JSON string, quotes included; bytes that are not UTF-8 become U+FFFD.
std::string jsonText(const std::string& text);

// As JSON. A number that is whole but not an integer keeps its point ("1.0"), so that its kind survives.
std::string jsonText(const Value& value);

} // namespace kestrel
