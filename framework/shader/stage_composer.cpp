#include "shader/stage_composer.h"
#include "shader/names.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {
namespace {

const std::string& defineText(const std::string& text) {
    static const std::string one = "1";
    return text.empty() ? one : text;
}

std::string defineLine(const std::string& name, const std::string& text) {
    return fmt::format("#define {} {}\n", name, defineText(text));
}

std::vector<std::string> keysOf(const std::map<std::string, ModuleInstance>& modules) {
    std::vector<std::string> keys;
    keys.reserve(modules.size());
    for (const auto& [key, instance] : modules) keys.push_back(key);
    return keys;
}

} // namespace

StageComposer::StageComposer(const ProgramRequest& request, ShaderLibrary& library,
                             std::vector<Problem>& problems, std::set<std::string>& dependencies)
    : request_(request)
    , library_(library)
    , problems_(problems)
    , dependencies_(dependencies) {}

ComposedStage StageComposer::compose(const std::string& file, ShaderStage stage) {
    sources_ = {"(head)"};
    const std::string* text = library_.find(file);
    if (text) {
        appendFile(file, *text, {Scope::Consumer, {}, &request_.defines, &request_.modules}, Truth::Yes);
    } else {
        problems_.push_back({{}, library_.missing(file)});
    }
    return {stage, head() + out_, sources_, file};
}

// The defines keep the line numbers that they have without extensions: "(head)" reads the same in every
// variant.
std::string StageComposer::head() const {
    std::string text = "#version 460 core\n";
    for (const Extension& extension : extensions_)
        text += fmt::format("#line {} {}\n{}\n", extension.line, extension.source, extension.text);
    if (!extensions_.empty()) text += "#line 2 0\n";
    for (const auto& [name, value] : request_.defines) text += defineLine(name, value);
    return text;
}

int StageComposer::sourceIndex(const std::string& path) {
    const auto found = std::find(sources_.begin() + 1, sources_.end(), path);
    const auto index = static_cast<int>(found - sources_.begin());
    if (found == sources_.end()) sources_.push_back(path);
    return index;
}

void StageComposer::problem(const OpenFile& file, int line, std::string message) {
    problems_.push_back({{file.path, line}, std::move(message)});
}

std::set<std::string> StageComposer::appendFile(const std::string& path, const std::string& text,
                                                const Scope& scope, Truth included) {
    OpenFile file{path, scope, sourceIndex(path), included, {}, {}};
    dependencies_.insert(path);
    out_ += fmt::format("#line 1 {}\n", file.source);
    for (const ShaderLine& line : shaderLines(text)) appendLine(file, line);
    checkConditionalsClosed(file);
    return std::move(file.macros);
}

// A module's macros end with its text: the next instance may have other values.
void StageComposer::appendModule(const std::string& path, const std::string& text, const Scope& scope,
                                 Truth included) {
    for (const std::string& name : appendFile(path, text, scope, included)) {
        out_ += fmt::format("#undef {}\n", name);
        macros_.erase(name);
    }
}

void StageComposer::checkConditionalsClosed(const OpenFile& file) {
    if (file.conditionals.open())
        problem(file, file.conditionals.line(), "this conditional has no #endif in its file");
}

void StageComposer::appendBlank(const ShaderLine& line) {
    out_.append(static_cast<size_t>(line.count), '\n');
}

void StageComposer::appendLine(OpenFile& file, const ShaderLine& line) {
    const std::optional<Directive> directive = directiveOf(line.code);
    const bool wasForCpp = file.conditionals.onlyForCpp();
    if (directive) {
        const auto lookup = [&](std::string_view name) { return macro(name, file.scope); };
        const auto result = file.conditionals.take(*directive, line.number, lookup);
        if (result == ConditionalStack::Result::WithoutIf)
            problem(file, line.number, fmt::format("#{} without #if in this file", directive->name));
        if (result == ConditionalStack::Result::AfterElse)
            problem(file, line.number, fmt::format("#{} after #else", directive->name));
    }
    // Both, so that the lines that begin and end the branch stay.
    if (wasForCpp && file.conditionals.onlyForCpp()) {
        appendBlank(line);
        return;
    }
    if (directive && takeDirective(file, line, *directive)) return;
    if (active(file) != Truth::No) {
        for (std::string& message : nameProblems(line.code)) problem(file, line.number, std::move(message));
    }
    out_ += line.raw;
    out_ += '\n';
}

// True if the line was written, or replaced.
bool StageComposer::takeDirective(OpenFile& file, const ShaderLine& line, const Directive& directive) {
    const std::string& name = directive.name;
    if (name == "pragma" && directive.rest == "once") {
        appendBlank(line);
        return true;
    }
    if (name == "include") {
        takeInclude(file, line, directive.rest);
        return true;
    }
    if (name == "extension") {
        takeExtension(file, line, directive);
        return true;
    }
    if (active(file) == Truth::No) return false;
    if (name == "define" || name == "undef") return !takeMacro(file, line, directive);
    if (name == "version" || name == "line") {
        problem(file, line.number,
                fmt::format("#{} is written by composition: remove it from the file", name));
        appendBlank(line);
        return true;
    }
    return false;
}

void StageComposer::takeInclude(OpenFile& file, const ShaderLine& line, std::string_view what) {
    bool appended = false;
    if (active(file) != Truth::No) {
        const std::optional<IncludeTarget> target = includeTargetOf(what);
        if (!target) {
            problem(file, line.number,
                    fmt::format("cannot read '#include {}': write #include \"folder/file.glsl\", "
                                "#include <port:NAME> or, in a module, #include <part:folder/file.glsl>",
                                what));
        } else if (target->kind == IncludeTarget::Port) {
            appended = includePort(file, line, target->name);
        } else if (target->kind == IncludeTarget::Part) {
            appended = includePart(file, line, target->name);
        } else {
            appended = includeLibrary(file, line, target->name);
        }
    }
    if (appended) {
        out_ += fmt::format("#line {} {}\n", line.number + line.count, file.source);
    } else {
        appendBlank(line);
    }
}

bool StageComposer::includeLibrary(OpenFile& file, const ShaderLine& line, const std::string& path) {
    if (libraries_.contains(path)) return false;
    if (active(file) == Truth::Unknown) {
        problem(file, line.number,
                fmt::format("'{}' is included where the program's defines do not decide whether it is "
                            "compiled: it could be missing elsewhere; include it outside the conditional",
                            path));
        return false;
    }
    const std::string* text = library_.find(path);
    if (!text) {
        problem(file, line.number, library_.missing(path));
        return false;
    }
    libraries_.insert(path);
    const Scope scope{Scope::Library, {}, &request_.defines, nullptr, file.scope.depth};
    switchScope(file.scope, scope);
    appendFile(path, *text, scope, Truth::Yes);
    switchScope(scope, file.scope);
    return true;
}

bool StageComposer::includePart(OpenFile& file, const ShaderLine& line, const std::string& path) {
    if (file.scope.kind != Scope::Module) {
        problem(file, line.number,
                fmt::format("only a module has parts ('{}'): include a library file", path));
        return false;
    }
    if (active(file) == Truth::Unknown) {
        problem(file, line.number,
                fmt::format("the part '{}' is included where the module's defines do not decide "
                            "whether it is compiled",
                            path));
        return false;
    }
    if (!parts_.insert({file.scope.prefix, path}).second) return false;
    const std::string* text = library_.find(path);
    if (!text) {
        problem(file, line.number, library_.missing(path));
        return false;
    }
    const std::set<std::string> macros = appendFile(path, *text, file.scope, Truth::Yes);
    file.macros.insert(macros.begin(), macros.end());
    return true;
}

bool StageComposer::includePort(OpenFile& file, const ShaderLine& line, const std::string& port) {
    if (!file.scope.modules) {
        problem(file, line.number,
                fmt::format("a library file cannot include the module of a port ('{}')", port));
        return false;
    }
    if (const std::string why = whyNotAName(port); !why.empty()) {
        problem(file, line.number, fmt::format("the port name '{}' {}", port, why));
        return false;
    }
    const auto& modules = *file.scope.modules;
    const auto found = modules.find(port);
    if (found == modules.end()) {
        if (active(file) == Truth::Yes)
            problem(file, line.number,
                    fmt::format("no module is connected to port '{}'{}", port,
                                didYouMean(port, keysOf(modules))));
        return false;
    }
    const ModuleInstance& instance = found->second;
    const std::string prefix = file.scope.prefix.empty() ? port : file.scope.prefix + "_" + port;
    if (!mayIncludeInstance(file, line, prefix, instance)) return false;
    if (!definesFit(file, line, port, instance)) return false;
    const std::string* text = library_.find(instance.file);
    if (!text) {
        problem(file, line.number,
                fmt::format("the module at port '{}': {}", port, library_.missing(instance.file)));
        return false;
    }
    instances_[prefix] = {&instance, active(file)};
    const Scope scope{Scope::Module, prefix, &instance.defines, &instance.modules, file.scope.depth + 1};
    switchScope(file.scope, scope);
    appendModule(instance.file, *text, scope, active(file));
    switchScope(scope, file.scope);
    return true;
}

// False if the instance is there already, or cannot be included.
bool StageComposer::mayIncludeInstance(OpenFile& file, const ShaderLine& line, const std::string& prefix,
                                       const ModuleInstance& instance) {
    if (file.scope.depth >= maxModuleDepth) {
        problem(file, line.number,
                fmt::format("modules in modules deeper than {}: '{}'", maxModuleDepth, prefix));
        return false;
    }
    const auto known = instances_.find(prefix);
    if (known == instances_.end()) return true;
    if (known->second.instance != &instance) {
        problem(file, line.number,
                fmt::format("two modules would get the same names '{}_...': rename a port", prefix));
    } else if (known->second.certain == Truth::Unknown) {
        problem(file, line.number,
                fmt::format("the module '{}' is included a second time, and the defines do not decide "
                            "whether the first is compiled",
                            prefix));
    }
    return false;
}

bool StageComposer::definesFit(OpenFile& file, const ShaderLine& line, const std::string& port,
                               const ModuleInstance& instance) {
    bool fit = true;
    for (const auto& [name, text] : instance.defines) {
        const auto known = macros_.find(name);
        std::string why = whyNotAName(name);
        if (why.empty() && text.find('\n') != std::string::npos) why = "has a text of more than one line";
        if (why.empty() && known != macros_.end() && known->second.defined != Truth::No)
            why = "is a macro that the text before it defines too";
        if (why.empty()) continue;
        fit = false;
        problem(file, line.number,
                fmt::format("the define '{}' of the module at port '{}' {}", name, port, why));
    }
    return fit;
}

// Ends what only `from` means and begins what only `to` means.
void StageComposer::switchScope(const Scope& from, const Scope& to) {
    const auto stays = [](const auto& define, const Defines& other) {
        const auto found = other.find(define.first);
        return found != other.end() && found->second == define.second;
    };
    if (!from.prefix.empty()) out_ += "#undef M\n";
    for (const auto& define : *from.defines)
        if (!stays(define, *to.defines)) out_ += fmt::format("#undef {}\n", define.first);
    for (const auto& define : *to.defines)
        if (!stays(define, *from.defines)) out_ += defineLine(define.first, define.second);
    if (!to.prefix.empty()) out_ += fmt::format("#define M(x) {}_##x\n", to.prefix);
}

void StageComposer::takeExtension(OpenFile& file, const ShaderLine& line, const Directive& directive) {
    // Blank too where it is not compiled: what is left in the text is what the program really asks for.
    appendBlank(line);
    if (active(file) == Truth::No) return;
    if (active(file) == Truth::Unknown) {
        problem(file, line.number,
                "#extension stands where the program's defines do not decide whether it is compiled");
        return;
    }
    const std::string text = "#extension " + directive.rest;
    const bool known = std::any_of(extensions_.begin(), extensions_.end(),
                                   [&](const Extension& extension) { return extension.text == text; });
    if (!known) extensions_.push_back({text, file.source, line.number});
}

// Records what a #define or #undef of a file means for later conditionals. False if it is refused.
bool StageComposer::takeMacro(OpenFile& file, const ShaderLine& line, const Directive& directive) {
    const std::optional<MacroLine> macroLine = macroLineOf(directive);
    if (!macroLine) return true; // the compiler says what is wrong with it
    const std::string& name = macroLine->name;
    if (name == "M" || request_.defines.contains(name) || file.scope.defines->contains(name)) {
        problem(file, line.number,
                fmt::format("#{} {}: the name is {}", directive.name, name,
                            name == "M" ? "reserved for the prefix of module names"
                                        : "given by the program's defines; guard a default with #ifndef"));
        appendBlank(line);
        return false;
    }
    const bool defines = directive.name == "define";
    MacroState state{defines ? Truth::Yes : Truth::No, macroLine->takesArguments ? "()" : macroLine->text};
    if (active(file) == Truth::Unknown) state.defined = Truth::Unknown;
    if (defines && !macros_.contains(name)) file.macros.insert(name);
    macros_[name] = std::move(state);
    return true;
}

MacroState StageComposer::macro(std::string_view name, const Scope& scope) const {
    const std::string key(name);
    if (name == "__VERSION__") return {Truth::Yes, "460"};
    if (name == "GL_core_profile") return {Truth::Yes, "1"};
    if (name.starts_with("GL_")) return {Truth::Unknown, {}};
    if (name == "M") return {scope.prefix.empty() ? Truth::No : Truth::Yes, "()"};
    if (const auto known = scope.defines->find(key); known != scope.defines->end())
        return {Truth::Yes, defineText(known->second)};
    if (const auto known = macros_.find(key); known != macros_.end()) return known->second;
    return {Truth::No, {}};
}

} // namespace kestrel
