#include "shader/condition.h"
#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>

namespace kestrel {
namespace {

using Value = std::optional<long long>; // nothing: not known

// Macros that stand for each other are followed this far.
constexpr int maxMacroDepth = 16;
// Parentheses and unary operators nest at most this deep.
constexpr int maxNesting = 64;

Truth truthOf(const Value& value) {
    if (!value) return Truth::Unknown;
    return *value != 0 ? Truth::Yes : Truth::No;
}

Value valueOf(Truth truth) {
    if (truth == Truth::Unknown) return std::nullopt;
    return truth == Truth::Yes ? 1 : 0;
}

Value parseInteger(std::string_view text) {
    while (!text.empty() && (text.back() == 'u' || text.back() == 'U')) text.remove_suffix(1);
    int base = 10;
    if (text.starts_with("0x") || text.starts_with("0X")) {
        base = 16;
        text.remove_prefix(2);
    } else if (text.size() > 1 && text.front() == '0') {
        base = 8;
    }
    long long value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value, base);
    if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

// The value of a name in an #if. A macro's text is followed only where it is one integer or one name: a
// longer one would have to be substituted as text.
Value macroValue(std::string_view name, const MacroLookup& lookup, int depth = 0) {
    const MacroState state = lookup(name);
    if (state.defined == Truth::No) return 0;
    if (state.defined == Truth::Unknown || depth > maxMacroDepth) return std::nullopt;
    const std::string_view text = trimmed(state.text);
    if (isIdentifier(text)) return macroValue(text, lookup, depth + 1);
    if (text.starts_with('-')) {
        const Value value = parseInteger(text.substr(1));
        return value ? Value(-*value) : value;
    }
    return parseInteger(text);
}

struct BinaryOperator {
    std::string_view text;
    int precedence; // higher binds tighter
};
// Longer texts first: the first that matches is the operator.
constexpr std::array<BinaryOperator, 18> operators{{{"||", 1},
                                                    {"&&", 2},
                                                    {"==", 6},
                                                    {"!=", 6},
                                                    {"<=", 7},
                                                    {">=", 7},
                                                    {"<<", 8},
                                                    {">>", 8},
                                                    {"|", 3},
                                                    {"^", 4},
                                                    {"&", 5},
                                                    {"<", 7},
                                                    {">", 7},
                                                    {"+", 9},
                                                    {"-", 9},
                                                    {"*", 10},
                                                    {"/", 10},
                                                    {"%", 10}}};

Value applyArithmetic(std::string_view op, long long a, long long b) {
    const auto wrapped = [](unsigned long long value) { return static_cast<long long>(value); };
    const auto ua = static_cast<unsigned long long>(a);
    const auto ub = static_cast<unsigned long long>(b);
    const bool overflows = a == std::numeric_limits<long long>::min() && b == -1;
    if (op == "==") return a == b;
    if (op == "!=") return a != b;
    if (op == "<=") return a <= b;
    if (op == ">=") return a >= b;
    if (op == "<") return a < b;
    if (op == ">") return a > b;
    if (op == "|") return a | b;
    if (op == "^") return a ^ b;
    if (op == "&") return a & b;
    if (op == "+") return wrapped(ua + ub);
    if (op == "-") return wrapped(ua - ub);
    if (op == "*") return wrapped(ua * ub);
    if ((op == "<<" || op == ">>") && (b < 0 || b > 62)) return std::nullopt;
    if (op == "<<") return wrapped(ua << ub);
    if (op == ">>") return a >> b;
    if (b == 0 || overflows) return std::nullopt;
    return op == "/" ? a / b : a % b;
}

Value apply(std::string_view op, const Value& a, const Value& b) {
    if (op == "&&") return valueOf(truthOf(a) && truthOf(b));
    if (op == "||") return valueOf(truthOf(a) || truthOf(b));
    if (!a || !b) return std::nullopt;
    return applyArithmetic(op, *a, *b);
}

// Precedence climbing over the text. Whatever it cannot read makes `failed`.
class ExpressionParser {
public:
    ExpressionParser(std::string_view text, const MacroLookup& lookup)
        : rest_(trimmed(text))
        , lookup_(lookup) {}

    Value parse() {
        const Value value = binary(1);
        return failed_ || !rest_.empty() ? std::nullopt : value;
    }

private:
    void drop(size_t count) { rest_ = trimmed(rest_.substr(count)); }
    bool accept(std::string_view text) {
        if (!rest_.starts_with(text)) return false;
        drop(text.size());
        return true;
    }
    const BinaryOperator* nextOperator() const {
        const auto* found = std::find_if(operators.begin(), operators.end(),
                                         [this](const auto& op) { return rest_.starts_with(op.text); });
        return found == operators.end() ? nullptr : found;
    }

    Value binary(int least) {
        Value left = unary();
        for (const BinaryOperator* op = nextOperator(); op && op->precedence >= least && !failed_;
             op = nextOperator()) {
            drop(op->text.size());
            left = apply(op->text, left, binary(op->precedence + 1));
        }
        return left;
    }

    Value unary() {
        if (++nesting_ > maxNesting) return fail();
        const Value value = unaryInside();
        --nesting_;
        return value;
    }

    Value unaryInside() {
        if (accept("!")) return valueOf(!truthOf(unary()));
        if (accept("~")) {
            const Value value = unary();
            return value ? Value(~*value) : value;
        }
        if (accept("-")) return apply("-", 0, unary());
        if (accept("+")) return unary();
        if (accept("(")) {
            const Value value = binary(1);
            return accept(")") ? value : fail();
        }
        return primary();
    }

    Value primary() {
        size_t length = 0;
        while (length < rest_.size() &&
               (isIdentifier(rest_.substr(length, 1)) || (rest_[length] >= '0' && rest_[length] <= '9')))
            ++length;
        if (length == 0) return fail();
        const std::string_view word = rest_.substr(0, length);
        drop(length);
        if (!isIdentifier(word)) return parseInteger(word);
        if (word == "defined") return isDefined();
        return macroValue(word, lookup_);
    }

    Value isDefined() {
        const bool parenthesis = accept("(");
        const std::vector<std::string_view> names = identifiersOf(rest_);
        if (names.empty() || !rest_.starts_with(names.front())) return fail();
        drop(names.front().size());
        if (parenthesis && !accept(")")) return fail();
        return valueOf(lookup_(names.front()).defined);
    }

    Value fail() {
        failed_ = true;
        return std::nullopt;
    }

    std::string_view rest_;
    const MacroLookup& lookup_;
    int nesting_ = 0;
    bool failed_ = false;
};

bool asksForCpp(const Directive& directive) {
    const std::vector<std::string_view> names = identifiersOf(directive.rest);
    return std::find(names.begin(), names.end(), "__cplusplus") != names.end();
}

} // namespace

Truth operator!(Truth a) {
    if (a == Truth::Unknown) return a;
    return a == Truth::Yes ? Truth::No : Truth::Yes;
}

Truth operator&&(Truth a, Truth b) {
    if (a == Truth::No || b == Truth::No) return Truth::No;
    return a == Truth::Yes && b == Truth::Yes ? Truth::Yes : Truth::Unknown;
}

Truth operator||(Truth a, Truth b) { return !(!a && !b); }

Truth evaluateCondition(std::string_view expression, const MacroLookup& lookup) {
    return truthOf(ExpressionParser(expression, lookup).parse());
}

ConditionalStack::Result ConditionalStack::take(const Directive& directive, int line,
                                                const MacroLookup& lookup) {
    const std::string& name = directive.name;
    const auto isDefined = [&] {
        const std::vector<std::string_view> names = identifiersOf(directive.rest);
        return names.empty() ? Truth::Unknown : lookup(names.front()).defined;
    };
    if (name == "if" || name == "ifdef" || name == "ifndef") {
        const Truth truth = name == "if"      ? evaluateCondition(directive.rest, lookup)
                            : name == "ifdef" ? isDefined()
                                              : !isDefined();
        frames_.push_back({truth, truth, asksForCpp(directive), false, line});
        return Result::Done;
    }
    if (name != "elif" && name != "else" && name != "endif") return Result::NotConditional;
    if (frames_.empty()) return Result::WithoutIf;
    if (name == "endif") {
        frames_.pop_back();
        return Result::Done;
    }
    Frame& frame = frames_.back();
    if (frame.sawElse) return Result::AfterElse;
    const Truth truth = name == "elif" ? evaluateCondition(directive.rest, lookup) : Truth::Yes;
    frame.branch = !frame.taken && truth;
    frame.taken = frame.taken || truth;
    frame.cpp = frame.cpp || asksForCpp(directive);
    frame.sawElse = name == "else";
    return Result::Done;
}

Truth ConditionalStack::active() const {
    Truth truth = Truth::Yes;
    for (const Frame& frame : frames_) truth = truth && frame.branch;
    return truth;
}

bool ConditionalStack::onlyForCpp() const {
    return std::any_of(frames_.begin(), frames_.end(),
                       [](const Frame& frame) { return frame.cpp && frame.branch == Truth::No; });
}

} // namespace kestrel
