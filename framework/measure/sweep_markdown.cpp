// results.md: the tables of a results.json as Markdown, for pages that people read without a browser's
// scripts.
#include "core/error.h"
#include "measure/sweep_results.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

namespace kestrel {
namespace {

using TableJson = nlohmann::ordered_json;

// Three digits that count; "-" for what was not measured.
std::string threeDigits(double value) {
    if (!std::isfinite(value)) return "-";
    if (value == 0) return "0";
    const int before = static_cast<int>(std::floor(std::log10(std::abs(value)))) + 1;
    return fmt::format("{:.{}f}", value, std::clamp(3 - before, 0, 9));
}

// Text that Markdown takes for nothing else, on one line.
std::string plainText(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '\n' || c == '\r' || c == '\t')
            result += ' ';
        else if (std::string_view("|\\`*_<>[]#").find(c) != std::string_view::npos)
            result += std::string("\\") + c;
        else
            result += c;
    }
    return result;
}

std::string digitsOf(const TableJson& value) {
    return value.is_number() ? threeDigits(value.get<double>()) : "-";
}

std::string bytesText(double bytes) { return threeDigits(bytes / (1 << 20)); }

// One column of a table: there if any row has it.
struct Column {
    std::string title;
    std::function<std::string(const TableJson& row)> text;
};

std::vector<Column> columnsOf(const TableJson& document, const std::vector<const TableJson*>& rows,
                              bool manyMachines) {
    std::vector<Column> columns;
    columns.push_back({"variant", [](const TableJson& row) {
                           const std::string name = plainText(row.at("variant").get<std::string>());
                           return row.at("pareto") == true ? "**" + name + "**" : name;
                       }});
    if (manyMachines)
        columns.push_back(
            {"machine", [](const TableJson& row) { return row.at("machine").get<std::string>(); }});
    std::vector<std::string> times{document.at("plot").at("time").get<std::string>()};
    for (const char* time : {"generation", "tracing", "filter", "total"})
        if (std::ranges::find(times, time) == times.end()) times.emplace_back(time);
    for (const std::string& time : times)
        columns.push_back({plainText(time) + ", ms", [time](const TableJson& row) {
                               return digitsOf(row.at("ms").value(time, TableJson()));
                           }});
    columns.push_back({"half quartile distance", [time = times.front()](const TableJson& row) {
                           const TableJson low = row.at("ms_q1").value(time, TableJson()),
                                           high = row.at("ms_q3").value(time, TableJson());
                           if (!low.is_number() || !high.is_number()) return std::string("-");
                           return threeDigits((high.get<double>() - low.get<double>()) / 2);
                       }});
    columns.push_back({"FLIP", [](const TableJson& row) { return digitsOf(row.at("flip")); }});
    columns.push_back({"RMSE", [](const TableJson& row) {
                           const TableJson& mse = row.at("mse");
                           return mse.is_number() ? threeDigits(std::sqrt(mse.get<double>())) : "-";
                       }});
    for (const auto& [title, key] : {std::pair{"MSE of the representation", "representation"},
                                     {"of the algorithm", "algorithm"},
                                     {"of both together", "cross"},
                                     {"of its noise", "sampling"},
                                     {"of the reference's noise", "reference_noise"}})
        columns.push_back({title, [key = key](const TableJson& row) {
                               return row.contains("split") ? digitsOf(row["split"].at(key)) : "-";
                           }});
    columns.push_back({"rays that agree, %", [](const TableJson& row) {
                           if (!row.contains("rays")) return std::string("-");
                           return fmt::format("{:.2f}", 100 * row["rays"].at("agreement").get<double>());
                       }});
    columns.push_back(
        {"memory, MiB", [](const TableJson& row) { return bytesText(row.at("memory").get<double>()); }});
    std::erase_if(columns, [&](const Column& column) {
        return std::ranges::all_of(rows, [&](const TableJson* row) { return column.text(*row) == "-"; });
    });
    return columns;
}

std::string tableText(const TableJson& document, const std::vector<const TableJson*>& rows,
                      bool manyMachines) {
    const std::vector<Column> columns = columnsOf(document, rows, manyMachines);
    std::string text = "|", line = "|";
    for (const Column& column : columns) {
        text += " " + column.title + " |";
        line += column.title == "variant" || column.title == "machine" ? "---|" : "---:|";
    }
    text += "\n" + line + "\n";
    for (const TableJson* row : rows) {
        text += "|";
        const bool failed = row->at("failed").is_string();
        for (const Column& column : columns)
            text += " " + (failed && column.title != "variant" ? "failed" : column.text(*row)) + " |";
        text += "\n";
    }
    return text;
}

std::string spinText(const TableJson& spin) {
    return fmt::format("{} ms ({} to {})", digitsOf(spin.at("median")), digitsOf(spin.at("min")),
                       digitsOf(spin.at("max")));
}

std::string machineText(const TableJson& machine) {
    const TableJson& spin = machine.at("spin");
    return fmt::format(
        "Machine {}, {}: {}, {} threads; {}; {}; clock: {}; Kestrel {}. Spin test: one thread {}, two at "
        "once {}.",
        machine.at("id").get<std::string>(), machine.at("date").get<std::string>(),
        plainText(machine.at("cpu").get<std::string>()), machine.at("threads").get<int>(),
        plainText(machine.at("renderer").get<std::string>()),
        plainText(machine.at("driver").get<std::string>()), plainText(machine.at("clock").get<std::string>()),
        machine.at("version").get<std::string>(), spinText(spin.at("one_thread_ms")),
        spinText(spin.at("two_threads_ms")));
}

// What differs from the default.
std::string foundText(const TableJson& point) {
    std::string text;
    for (size_t i = 0; i < point.at("set").size(); ++i)
        if (point.at("set")[i] != point.at("start").at(i))
            text += (text.empty() ? "" : ", ") + plainText(point.at("set")[i].get<std::string>());
    return text.empty() ? "the default" : text;
}

std::string listText(const TableJson& names) {
    std::string text;
    for (const TableJson& name : names)
        text += (text.empty() ? "" : ", ") + plainText(name.get<std::string>());
    return text;
}

// What `kestrel tune` found, and whether ranks change.
std::string tuneMarkdown(const TableJson& tuning) {
    std::string text = fmt::format(
        "\n### Tuned\n\nOn {}; held out: {}. {} of {} defaults are within 5 % of their tuned error. Tuning "
        "changed the ranks of {} of {} plots that were held out.\n\n",
        listText(tuning.at("train")), listText(tuning.at("hold_out")),
        tuning.at("defaults_within_5_percent").get<int>(), tuning.at("points").size(),
        tuning.at("held_out_plots_changed").get<int>(), tuning.at("held_out_plots").get<int>());
    text +=
        "| variant | found | error, default | tuned | held out, default | tuned | time | settings tried |\n"
        "|---|---|---:|---:|---:|---:|---:|---:|\n";
    for (const TableJson& point : tuning.at("points"))
        text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n",
                            plainText(point.at("variant").get<std::string>()), foundText(point),
                            digitsOf(point.at("start_error")), digitsOf(point.at("error")),
                            digitsOf(point.at("held_out_start_error")), digitsOf(point.at("held_out_error")),
                            digitsOf(point.at("time_ratio")), point.at("asked").get<int>());
    return text;
}

std::string documentText(const TableJson& document) {
    std::string text = fmt::format("## {}\n\n", plainText(document.at("title").get<std::string>()));
    if (const auto comment = document.at("comment").get<std::string>(); !comment.empty())
        text += plainText(comment) + "\n\n";
    text += fmt::format("    {}\n\n", document.at("command").get<std::string>());
    text += fmt::format("{}x{}, pictures after {} frames, medians of {} repetitions of {} timed frames{}.",
                        document.at("size").at(0).get<int>(), document.at("size").at(1).get<int>(),
                        document.at("frames").get<int>(), document.at("repeats").get<int>(),
                        document.at("timed_frames").get<int>(),
                        document.at("rebuild") == true ? ", each with everything made anew" : "");
    const TableJson& machines = document.at("machines");
    for (const TableJson& machine : machines) text += "\n" + machineText(machine);
    if (machines.size() > 1) text += "\nTimes compare within one machine only.";
    text += "\nIn bold: on the Pareto front of its plot.\n";
    std::vector<std::pair<std::string, std::vector<const TableJson*>>> plots;
    for (const TableJson& row : document.at("rows")) {
        std::string name = row.at("scene").get<std::string>();
        if (const auto plot = row.at("plot").get<std::string>(); !plot.empty()) name += ": " + plot;
        auto found = std::ranges::find(plots, name, [](const auto& plot) { return plot.first; });
        if (found == plots.end()) found = plots.insert(found, {name, {}});
        found->second.push_back(&row);
    }
    std::set<std::string> blank;
    for (const TableJson& scene : document.at("scenes"))
        if (scene.value("nothing_counts", false)) blank.insert(scene.at("name").get<std::string>());
    for (const auto& [name, rows] : plots) {
        text += fmt::format("\n### {}\n\n", plainText(name));
        if (blank.contains(rows.front()->at("scene").get<std::string>()))
            text += "No pixel counts here, since the mask is 0 everywhere: times without errors.\n\n";
        text += tableText(document, rows, machines.size() > 1);
    }
    if (document.contains("tuning")) text += tuneMarkdown(document["tuning"]);
    if (const size_t missing = document.at("missing").size(); missing > 0)
        text += fmt::format("\nNot measured yet: {} more.\n", missing);
    return text;
}

} // namespace

std::string resultsMarkdown(const std::string& json, const std::string& file) {
    try {
        const TableJson document = TableJson::parse(json);
        if (document.at("kestrel_sweep_results") != 1)
            throw InputError(Location{file}, "'kestrel_sweep_results' must be 1");
        return documentText(document);
    } catch (const TableJson::exception&) {
        throw InputError(Location{file}, "is no results.json of a sweep, or of another version of Kestrel");
    }
}

} // namespace kestrel
