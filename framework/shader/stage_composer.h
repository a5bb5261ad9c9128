// Composes the text of one stage; compose.h states the rules.
#pragma once
#include "shader/compose.h"
#include "shader/condition.h"
#include "shader/lines.h"
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace kestrel {

class StageComposer {
public:
    // Problems are added to `problems`, read files to `dependencies`; both are the program's.
    StageComposer(const ProgramRequest& request, ShaderLibrary& library, std::vector<Problem>& problems,
                  std::set<std::string>& dependencies);

    ComposedStage compose(const std::string& file, ShaderStage stage);

private:
    // What names mean in a stretch of text: the stage's own file (no prefix, the request's modules), a module
    // instance, or a library file (neither).
    struct Scope {
        enum Kind { Consumer, Library, Module } kind = Library;
        std::string prefix;               // of M; empty: M is not defined
        const Defines* defines = nullptr; // a module's own, else the program's
        const std::map<std::string, ModuleInstance>* modules = nullptr;
        int depth = 0;
    };
    // One file while its text is written.
    struct OpenFile {
        const std::string& path;
        const Scope& scope;
        int source;     // index of #line
        Truth included; // whether the include that led here is compiled
        ConditionalStack conditionals;
        std::set<std::string> macros; // that it defines itself
    };
    struct Included {
        const ModuleInstance* instance = nullptr;
        Truth certain = Truth::Yes;
    };
    struct Extension {
        std::string text;
        int source = 0;
        int line = 0;
    };

    // The macros that the file and its parts define.
    std::set<std::string> appendFile(const std::string& path, const std::string& text, const Scope& scope,
                                     Truth included);
    void appendModule(const std::string& path, const std::string& text, const Scope& scope, Truth included);
    void appendLine(OpenFile& file, const ShaderLine& line);
    bool takeDirective(OpenFile& file, const ShaderLine& line, const Directive& directive);
    void takeInclude(OpenFile& file, const ShaderLine& line, std::string_view what);
    bool includeLibrary(OpenFile& file, const ShaderLine& line, const std::string& path);
    bool includePart(OpenFile& file, const ShaderLine& line, const std::string& path);
    bool includePort(OpenFile& file, const ShaderLine& line, const std::string& port);
    bool mayIncludeInstance(OpenFile& file, const ShaderLine& line, const std::string& prefix,
                            const ModuleInstance& instance);
    bool definesFit(OpenFile& file, const ShaderLine& line, const std::string& port,
                    const ModuleInstance& instance);
    void takeExtension(OpenFile& file, const ShaderLine& line, const Directive& directive);
    bool takeMacro(OpenFile& file, const ShaderLine& line, const Directive& directive);
    void checkConditionalsClosed(const OpenFile& file);

    void switchScope(const Scope& from, const Scope& to);
    void appendBlank(const ShaderLine& line);
    [[nodiscard]] std::string head() const;
    [[nodiscard]] MacroState macro(std::string_view name, const Scope& scope) const;
    [[nodiscard]] Truth active(const OpenFile& file) const {
        return file.included && file.conditionals.active();
    }
    int sourceIndex(const std::string& path);
    void problem(const OpenFile& file, int line, std::string message);

    const ProgramRequest& request_;
    ShaderLibrary& library_;
    std::vector<Problem>& problems_;
    std::set<std::string>& dependencies_;
    std::string out_;
    std::vector<std::string> sources_;
    std::vector<Extension> extensions_;
    std::set<std::string> libraries_;                     // included so far
    std::set<std::pair<std::string, std::string>> parts_; // the same, by module's prefix and path
    std::map<std::string, Included> instances_;           // by prefix
    std::map<std::string, MacroState> macros_;            // that files define
};

} // namespace kestrel
