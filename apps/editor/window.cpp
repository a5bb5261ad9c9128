#include "window.h"
#define GLFW_INCLUDE_NONE
#include "gl/loader.h"
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <chrono>
#include <imgui.h>

namespace kestrel::edit {
namespace {

struct Events {
    KeyEvents* keys;
    std::vector<std::filesystem::path>* dropped;
    int* settle;
};

GLFWwindow* handle(const gl::Context& context) { return static_cast<GLFWwindow*>(context.window()); }

void woken(GLFWwindow* window) {
    if (const auto* events = static_cast<Events*>(glfwGetWindowUserPointer(window))) *events->settle = 3;
}

} // namespace

Window::Window(Extent size, Theme& theme) {
    context_ = gl::Context::create({.backend = gl::Backend::Window, .windowSize = size, .title = "Kestrel"});
    GLFWwindow* window = handle(*context_);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window, new Events{&keys_, &dropped_, &settle_});
    // Before ImGui's, which calls them on.
    glfwSetKeyCallback(window, [](GLFWwindow* of, int key, int, int action, int modifiers) {
        woken(of);
        if (action != GLFW_RELEASE)
            static_cast<Events*>(glfwGetWindowUserPointer(of))
                ->keys->push_back({.key = key,
                                   .ctrl = (modifiers & GLFW_MOD_CONTROL) != 0,
                                   .shift = (modifiers & GLFW_MOD_SHIFT) != 0,
                                   .alt = (modifiers & GLFW_MOD_ALT) != 0});
    });
    glfwSetDropCallback(window, [](GLFWwindow* of, int count, const char** files) {
        woken(of);
        for (int i = 0; i < count; ++i)
            static_cast<Events*>(glfwGetWindowUserPointer(of))->dropped->emplace_back(files[i]);
    });
    glfwSetCursorPosCallback(window, [](GLFWwindow* of, double, double) { woken(of); });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* of, int, int, int) { woken(of); });
    glfwSetScrollCallback(window, [](GLFWwindow* of, double, double) { woken(of); });
    glfwSetCharCallback(window, [](GLFWwindow* of, unsigned) { woken(of); });
    glfwSetFramebufferSizeCallback(window, [](GLFWwindow* of, int, int) { woken(of); });
    glfwSetWindowRefreshCallback(window, woken);
    glfwSetWindowCloseCallback(window, woken);
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr; // the editor keeps its own state
    ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
    theme.loadFonts();
    theme.apply();
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 430");
}

Window::~Window() {
    context_->makeCurrent();
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    delete static_cast<Events*>(glfwGetWindowUserPointer(handle(*context_)));
    glfwSetWindowUserPointer(handle(*context_), nullptr);
}

void Window::frame(Editor& editor, Theme& theme, const std::function<void(KeyEvents&)>& before) {
    if (editor.takeThemeChange()) {
        theme.loadFonts();
        theme.apply();
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        ImGui_ImplOpenGL3_CreateFontsTexture();
    }
    const auto begin = std::chrono::steady_clock::now();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    KeyEvents keys = std::exchange(keys_, {});
    if (before) before(keys);
    ImGui::NewFrame();
    for (const std::filesystem::path& file : std::exchange(dropped_, {})) editor.open(file);
    editor.show(keys);
    ImGui::Render();
    ownMs_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    const Extent extent = context_->framebufferExtent();
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, static_cast<GLsizei>(extent.width), static_cast<GLsizei>(extent.height));
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    glfwSetWindowTitle(handle(*context_), editor.title().c_str());
}

void Window::turn(Editor& editor, Theme& theme, const std::function<void(KeyEvents&)>& before) {
    // Nothing moves: sleep until somebody does something, or a file may have changed.
    if (settle_ > 0)
        --settle_;
    else if (!editor.busy() && !before) {
        glfwWaitEventsTimeout(0.5);
        if (settle_ == 0 && dropped_.empty() && editor.rests()) return;
    }
    frame(editor, theme, before);
    if (context_->present()) return;
    glfwSetWindowShouldClose(handle(*context_), GLFW_FALSE);
    editor.askToClose();
    settle_ = 3;
}

void Window::run(Editor& editor, Theme& theme, const std::function<void(KeyEvents&)>& before) {
    while (!editor.done()) turn(editor, theme, before);
}

void Window::runFor(Editor& editor, Theme& theme, double seconds) {
    const double end = glfwGetTime() + seconds;
    while (!editor.done() && glfwGetTime() < end) turn(editor, theme, {});
}

void Window::resize(Extent size) {
    glfwSetWindowSize(handle(*context_), static_cast<int>(size.width), static_cast<int>(size.height));
}

Image Window::screenshot() const {
    const Extent extent = context_->framebufferExtent();
    const auto width = static_cast<int>(extent.width), height = static_cast<int>(extent.height);
    std::vector<std::uint8_t> bytes(static_cast<size_t>(width) * static_cast<size_t>(height) * 3);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, bytes.data());
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    Image image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) =
                    static_cast<float>(
                        bytes[(static_cast<size_t>(height - 1 - y) * static_cast<size_t>(width) +
                               static_cast<size_t>(x)) *
                                  3 +
                              static_cast<size_t>(c)]) /
                    255.0f;
    return image;
}

} // namespace kestrel::edit
