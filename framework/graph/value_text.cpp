#include "graph/value_text.h"
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace kestrel {
namespace {

struct Writer {
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
    std::string operator()(double value) const {
        const std::string text = numberText(value);
        return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
    }
    std::string operator()(const std::string& value) const { return jsonText(value); }
    std::string operator()(const std::vector<double>& values) const {
        std::string text = "[";
        for (const double value : values)
            text += (text.size() > 1 ? ", " : std::string()) + numberText(value);
        return text + "]";
    }
};

} // namespace

std::string numberText(double number) {
    if (std::abs(number) <= std::numeric_limits<float>::max()) {
        const auto narrow = static_cast<float>(number);
        if (static_cast<double>(narrow) == number) return fmt::format("{}", narrow);
    }
    return fmt::format("{}", number);
}

std::string jsonText(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string jsonText(const Value& value) { return std::visit(Writer(), value); }

} // namespace kestrel
