// JSON that remembers where each value stands, so that every error names file:line:column.
#pragma once
#include "core/error.h"
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace kestrel {

// A located JSON value. Members keep the order of the file.
struct Json {
    enum class Kind { Null, Bool, Int, Float, String, Array, Object };
    struct Member;

    Kind kind = Kind::Null;
    Location where; // of the value's first character
    bool boolean = false;
    std::int64_t integer = 0; // valid for Int, and for a Float that is whole (see isWhole)
    double number = 0;        // valid for Int and Float
    std::string text;         // valid for String
    std::vector<Json> items;  // valid for Array
    std::vector<Member> members;

    // Parses UTF-8 text; `file` is only named in locations. Limits: 16 MiB, a million values, nesting 64.
    // Throws InputError with the place for text that is not JSON, a number beyond the range of double, and
    // for a key that occurs twice in one object.
    static Json parse(std::string_view text, const std::string& file);

    [[nodiscard]] bool isNumber() const { return kind == Kind::Int || kind == Kind::Float; }
    // Whether it is a whole number, as JSON schemas have it: 128.0 is one, up to 2^53.
    [[nodiscard]] bool isWhole() const;
    // The member's value or nullptr.
    [[nodiscard]] const Json* find(std::string_view key) const;
    // The kind in words, with its article: "a string".
    [[nodiscard]] std::string_view kindName() const;
};

struct Json::Member {
    std::string key;
    Location where; // of the key
    Json value;
};

// Reads the members of one object and notes every mistake instead of stopping at the first.
class JsonFields {
public:
    // Notes a problem if `object` is not an object. `what` names it in messages: "a pass", "the graph".
    JsonFields(const Json& object, std::string what, std::vector<Problem>& problems);

    // The member or nullptr; a missing required one is noted.
    const Json* required(std::string_view key);
    const Json* optional(std::string_view key);
    // As above, and of that kind, else noted and nullptr. Int takes any whole number (see isWhole), Float any
    // number.
    const Json* required(std::string_view key, Json::Kind kind);
    const Json* optional(std::string_view key, Json::Kind kind);
    // Notes every member that was not asked for, with the near name among those that were. Call it last.
    void refuseOthers();

private:
    const Json* checked(const Json* value, std::string_view key, Json::Kind kind);

    const Json& object_;
    std::string what_;
    std::vector<Problem>& problems_;
    std::vector<std::string> known_;
};

} // namespace kestrel
