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
    bool* exposed;
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
    glfwSetWindowUserPointer(window, new Events{&keys_, &dropped_, &settle_, &exposed_});
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
    glfwSetWindowRefreshCallback(window, [](GLFWwindow* of) {
        woken(of);
        *static_cast<Events*>(glfwGetWindowUserPointer(of))->exposed = true;
    });
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
    framebuffers_.clear();
    picture_ = {};
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
#if IMGUI_VERSION_NUM < 19200 // later it fills its texture as letters are asked for
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        ImGui_ImplOpenGL3_CreateFontsTexture();
#endif
        redraw_.forget();
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
    draw(editor);
    if (std::string title = editor.title(); title != title_) {
        title_ = std::move(title);
        glfwSetWindowTitle(handle(*context_), title_.c_str());
    }
}

void Window::draw(Editor& editor) {
    const Extent extent = context_->framebufferExtent();
    if (extent.width == 0 || extent.height == 0) return redraw_.forget(); // an icon
    if (!picture_ || picture_.desc().extent != extent) {
        framebuffers_.clear();
        picture_ = gl::Texture(Desc::texture2D(Format::RGBA8, extent), "window");
        redraw_.forget();
    }
    const std::vector<PixelBox> boxes = redraw_.changed(*ImGui::GetDrawData(), editor.viewport.takeWritten());
    for (const PixelBox& box : boxes) drawBox(box);
    if (!boxes.empty()) shows_ = false;
}

void Window::drawAgain() {
    const Extent extent = picture_.desc().extent;
    drawBox({0, 0, static_cast<int>(extent.width), static_cast<int>(extent.height)});
}

void Window::drawBox(const PixelBox& box) {
    const Extent extent = picture_.desc().extent;
    const int width = box.right - box.left, height = box.bottom - box.top;
    drawnPixels_ += static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    ImDrawData& data = *ImGui::GetDrawData();
    redraw_.limitTo(data, box);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers_.get({gl::Attachment{&picture_}}, {}, extent));
    glViewport(0, 0, static_cast<GLsizei>(extent.width), static_cast<GLsizei>(extent.height));
    glEnable(GL_SCISSOR_TEST);
    glScissor(box.left, static_cast<GLint>(extent.height) - box.bottom, width, height);
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_SCISSOR_TEST);
    ImGui_ImplOpenGL3_RenderDrawData(&data);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

bool Window::present() {
    if (shows_ && !exposed_) {
        glfwPollEvents();
        return glfwWindowShouldClose(handle(*context_)) == GLFW_FALSE;
    }
    if (picture_) {
        const Extent extent = picture_.desc().extent;
        const auto width = static_cast<GLint>(extent.width), height = static_cast<GLint>(extent.height);
        glBlitNamedFramebuffer(framebuffers_.get({gl::Attachment{&picture_}}, {}, extent), 0, 0, 0, width,
                               height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
    shows_ = true;
    exposed_ = false;
    return context_->present();
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
    if (present()) return;
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

Image Window::screenshot() const { return convertChannels(picture_.downloadImage(), 3); }

} // namespace kestrel::edit
