// What the GL tests share: one EGL context a process, programs from text, and no GL error left unseen.
#pragma once
#include "gl/context.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "shader/compose.h"
#include "support/folders.h"
#include "support/message.h"
#include <cstring>
#include <glad/gl.h>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace kestrel::test {

inline gl::Context& context() {
    static const std::unique_ptr<gl::Context> instance = [] {
        gl::setProgramCache("");
        return gl::Context::create();
    }();
    instance->makeCurrent();
    return *instance;
}

class GlTest : public ::testing::Test {
protected:
    void SetUp() override {
        context();
        errorsBefore_ = gl::Context::severeErrors();
    }
    void TearDown() override {
        EXPECT_EQ(gl::Context::severeErrors(), errorsBefore_) << "GL errors of high severity, see the log";
    }

private:
    std::uint64_t errorsBefore_ = 0;
};

// Composes virtual files ("a.vert", "a.frag"; texts without #version), with the shipped shaders to include.
inline ComposedProgram composeTexts(const std::vector<std::pair<std::string, std::string>>& files,
                                    const Defines& defines = {}) {
    ShaderLibrary library({test::sourceFolder() / "shaders"});
    ProgramRequest request;
    request.defines = defines;
    for (const auto& [file, text] : files) {
        library.addVirtual(file, text);
        request.files.push_back(file);
    }
    return compose(request, library);
}

inline gl::Program computeProgram(const std::string& text, const Defines& defines = {}) {
    return {composeTexts({{"test.comp", text}}, defines), {}, context().capabilities()};
}

inline const char* fullscreenVertex() {
    return "void main() {\n"
           "    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.5, 1.0);\n"
           "}\n";
}

template<class T>
std::vector<T> as(const std::vector<std::byte>& bytes) {
    std::vector<T> result(bytes.size() / sizeof(T));
    std::memcpy(result.data(), bytes.data(), result.size() * sizeof(T));
    return result;
}

} // namespace kestrel::test
