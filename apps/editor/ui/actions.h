// Everything that the editor does by a key, a menu or the palette, in one table: what it is called, its key,
// when it can be done.
#pragma once
#include "ui/keys.h"
#include <functional>
#include <string>
#include <vector>

namespace kestrel::edit {

struct Action {
    std::string menu, name; // "Edit", "Undo"
    Chord key;              // none: by menu and palette alone
    std::function<void()> run;
    std::function<bool()> enabled = {};       // empty: always
    std::function<std::string()> detail = {}; // behind the name: what would be undone, say

    [[nodiscard]] bool can() const { return !enabled || enabled(); }
    [[nodiscard]] std::string title() const { return detail ? name + " " + detail() : name; }
};

class Actions {
public:
    void add(Action action) { actions_.push_back(std::move(action)); }
    [[nodiscard]] const std::vector<Action>& all() const { return actions_; }
    // Runs what a key stands for; true if there is such an action and it can be done. With `typing` only
    // those with Ctrl or a function key, since letters go to the text.
    bool press(const Chord& key, bool typing) const;
    // Menus in the order in which they first stand in the table.
    void showMenus() const;
    // The page of shortcuts.
    void showShortcuts() const;

private:
    std::vector<Action> actions_;
};

// A list that narrows while one types, with the keyboard alone: arrows choose, Enter takes, Esc closes.
class Palette {
public:
    struct Entry {
        std::string title, detail;
        std::function<void()> run;
    };
    // What a typed text finds besides titles: titles of entries, in their order.
    using Finder = std::function<std::vector<std::string>(const std::string&)>;
    // Opens over the middle of the screen.
    void open(std::string prompt, std::vector<Entry> entries, Finder finder = {});
    void show(); // every frame
    [[nodiscard]] bool isOpen() const { return open_; }

private:
    std::string prompt_, typed_;
    std::vector<Entry> entries_;
    Finder finder_;
    size_t chosen_ = 0;
    bool open_ = false, fresh_ = false;
};

} // namespace kestrel::edit
