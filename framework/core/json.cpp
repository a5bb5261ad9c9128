#include "core/json.h"
#include "core/problems.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <unordered_map>

namespace kestrel {
namespace {

using nlohmann::ordered_json;

constexpr size_t maxJsonBytes = size_t{16} << 20;
constexpr size_t maxNesting = 64;
constexpr size_t maxJsonValues = 1'000'000; // each takes a hundred times the two bytes that it has in a file

// nlohmann-json 3.11 knows no positions. Its SAX events come in the order of the tokens, so a cursor that
// walks the text in step with the events knows where each token stands.
class Cursor {
public:
    Cursor(std::string_view text, const std::string& file)
        : text_(text)
        , place_{file, 1, 1} {}

    // Moves over white space and separators to the next token and returns its place.
    Location next() {
        while (at_ < text_.size() && std::string_view(" \t\r\n,:").find(text_[at_]) != std::string_view::npos)
            step();
        return place_;
    }
    void passCharacter() { step(); }
    void passWord() {
        while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) ||
                                      std::string_view("+-.").find(text_[at_]) != std::string_view::npos))
            step();
    }
    void passString() {
        step();
        while (at_ < text_.size() && text_[at_] != '"') {
            if (text_[at_] == '\\') step();
            step();
        }
        step();
    }
    // The place of the byte with this offset, for errors of the parser.
    Location at(size_t offset) {
        Cursor fresh(text_, place_.file);
        while (fresh.at_ < std::min(offset, text_.size())) fresh.step();
        return fresh.place_;
    }

private:
    void step() {
        if (at_ >= text_.size()) return;
        const auto byte = static_cast<unsigned char>(text_[at_++]);
        if (byte == '\n') {
            ++place_.line;
            place_.column = 1;
        } else if ((byte & 0xC0) != 0x80) { // columns count characters, not bytes
            ++place_.column;
        }
    }
    std::string_view text_;
    size_t at_ = 0;
    Location place_;
};

class Builder : public nlohmann::json_sax<ordered_json> {
public:
    Builder(std::string_view text, const std::string& file)
        : cursor_(text, file) {}

    Json root;

    bool null() override {
        return scalar(Json::Kind::Null, [](Json&) {});
    }
    bool boolean(bool value) override {
        return scalar(Json::Kind::Bool, [&](Json& json) { json.boolean = value; });
    }
    bool number_integer(number_integer_t value) override {
        return scalar(Json::Kind::Int, [&](Json& json) {
            json.integer = value;
            json.number = static_cast<double>(value);
        });
    }
    bool number_unsigned(number_unsigned_t value) override {
        if (value > static_cast<number_unsigned_t>(INT64_MAX))
            return number_float(static_cast<double>(value), {});
        return number_integer(static_cast<number_integer_t>(value));
    }
    bool number_float(number_float_t value, const string_t&) override {
        return scalar(Json::Kind::Float, [&](Json& json) {
            json.number = value;
            if (json.isWhole()) json.integer = static_cast<std::int64_t>(value);
        });
    }
    bool string(string_t& value) override {
        Json& json = put(Json::Kind::String);
        json.text = value;
        cursor_.passString();
        return true;
    }
    bool binary(binary_t&) override { return false; }
    bool start_object(std::size_t) override { return open(Json::Kind::Object); }
    bool start_array(std::size_t) override { return open(Json::Kind::Array); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }
    bool key(string_t& value) override {
        const Location where = cursor_.next();
        const auto [same, fresh] = keys_.back().try_emplace(value, where.line);
        if (!fresh)
            throw InputError(where, fmt::format("the key '{}' stands twice in one object (first on line {})",
                                                value, same->second));
        open_.back()->members.push_back({value, where, {}});
        cursor_.passString();
        return true;
    }
    bool parse_error(std::size_t position, const std::string& token,
                     const nlohmann::detail::exception& error) override {
        constexpr int numberOverflow = 406;
        if (error.id == numberOverflow)
            throw InputError(cursor_.next(), fmt::format("the number {} is too large: at most {:.4g} can be "
                                                         "read",
                                                         token, std::numeric_limits<double>::max()));
        // The library's own text repeats the position; what follows the last ": " is the reason.
        std::string reason = error.what();
        const size_t cut = reason.find(": ");
        if (cut != std::string::npos) reason = reason.substr(cut + 2);
        std::replace(reason.begin(), reason.end(), '\n', ' ');
        throw InputError(cursor_.at(position == 0 ? 0 : position - 1), "not JSON: " + reason);
    }

private:
    Json& put(Json::Kind kind) {
        const Location where = cursor_.next();
        if (++values_ > maxJsonValues)
            throw InputError(where, fmt::format("has more than {} values of JSON", maxJsonValues));
        Json* target = &root;
        if (!open_.empty()) {
            Json& parent = *open_.back();
            target = parent.kind == Json::Kind::Array ? &parent.items.emplace_back()
                                                      : &parent.members.back().value;
        }
        target->kind = kind;
        target->where = where;
        return *target;
    }
    template<class Fill>
    bool scalar(Json::Kind kind, const Fill& fill) {
        fill(put(kind));
        cursor_.passWord();
        return true;
    }
    bool open(Json::Kind kind) {
        Json& json = put(kind);
        if (open_.size() >= maxNesting)
            throw InputError(json.where, fmt::format("nested deeper than {} levels", maxNesting));
        open_.push_back(&json);
        keys_.emplace_back();
        cursor_.passCharacter();
        return true;
    }
    bool close() {
        cursor_.next();
        cursor_.passCharacter();
        open_.pop_back();
        keys_.pop_back();
        return true;
    }

    Cursor cursor_;
    size_t values_ = 0;
    std::vector<std::unordered_map<std::string, int>> keys_; // of the open containers, and their lines
    std::vector<Json*> open_; // stable: a container's vector does not grow while a child of it is open
};

} // namespace

Json Json::parse(std::string_view text, const std::string& file) {
    if (text.size() > maxJsonBytes)
        throw InputError(Location{file},
                         fmt::format("has {} bytes of JSON; at most {} are read", text.size(), maxJsonBytes));
    Builder builder(text, file);
    ordered_json::sax_parse(text, &builder);
    return std::move(builder.root);
}

bool Json::isWhole() const {
    constexpr double exact = 9007199254740992; // 2^53: above it not every whole number is a double
    if (kind == Kind::Int) return true;
    return kind == Kind::Float && std::abs(number) <= exact && number == std::floor(number);
}

const Json* Json::find(std::string_view key) const {
    for (const Member& member : members)
        if (member.key == key) return &member.value;
    return nullptr;
}

std::string_view Json::kindName() const {
    switch (kind) {
    case Kind::Null:
        return "null";
    case Kind::Bool:
        return "true or false";
    case Kind::Int:
        return "a whole number";
    case Kind::Float:
        return "a number";
    case Kind::String:
        return "a string";
    case Kind::Array:
        return "an array";
    case Kind::Object:
        return "an object";
    }
    return "a value";
}

JsonFields::JsonFields(const Json& object, std::string what, std::vector<Problem>& problems)
    : object_(object)
    , what_(std::move(what))
    , problems_(problems) {
    if (object.kind != Json::Kind::Object)
        noteProblem(problems_, object.where,
                    fmt::format("{} must be an object, not {}", what_, object.kindName()));
}

const Json* JsonFields::optional(std::string_view key) {
    known_.emplace_back(key);
    return object_.find(key);
}

const Json* JsonFields::required(std::string_view key) {
    const Json* value = optional(key);
    if (value == nullptr && object_.kind == Json::Kind::Object)
        noteProblem(problems_, object_.where, fmt::format("{} needs '{}'", what_, key));
    return value;
}

const Json* JsonFields::checked(const Json* value, std::string_view key, Json::Kind kind) {
    if (value == nullptr || value->kind == kind || (kind == Json::Kind::Float && value->isNumber()) ||
        (kind == Json::Kind::Int && value->isWhole()))
        return value;
    Json wanted;
    wanted.kind = kind;
    noteProblem(
        problems_, value->where,
        fmt::format("'{}' of {} must be {}, not {}", key, what_, wanted.kindName(), value->kindName()));
    return nullptr;
}

const Json* JsonFields::required(std::string_view key, Json::Kind kind) {
    return checked(required(key), key, kind);
}
const Json* JsonFields::optional(std::string_view key, Json::Kind kind) {
    return checked(optional(key), key, kind);
}

void JsonFields::refuseOthers() {
    for (const Json::Member& member : object_.members)
        if (std::find(known_.begin(), known_.end(), member.key) == known_.end())
            noteProblem(
                problems_, member.where,
                fmt::format("{} has no key '{}'{}", what_, member.key, didYouMean(member.key, known_)));
}

} // namespace kestrel
