#include "measure/page_html.h"
#include "measure/stress/stress_results.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace kestrel {
namespace {

using page::htmlText;

constexpr std::string_view style = R"css(
table.cases { border-collapse: collapse; font-size: 12.5px; }
table.cases th { font-weight: 600; text-align: left; padding: 3px 8px; white-space: nowrap; background: var(--card); }
table.cases thead th { vertical-align: bottom; writing-mode: vertical-rl; transform: rotate(180deg); padding: 8px 2px; }
table.cases thead th:first-child { writing-mode: horizontal-tb; transform: none; }
table.cases td { border: 1px solid var(--grid); min-width: 16px; height: 20px; text-align: center; padding: 0 3px; }
table.cases tbody th a { color: inherit; text-decoration-color: var(--line); text-underline-offset: 3px; }
table.cases tr:hover th, table.cases tr:hover td { border-color: var(--line); }
.held { background: color-mix(in srgb, var(--s2) 35%, transparent); }
.limit { background: color-mix(in srgb, var(--s4) 45%, transparent); }
.missed { background: color-mix(in srgb, var(--s6) 60%, transparent); font-weight: 600; }
.lacking { background: var(--grid); }
.key span { padding: 1px 8px; margin-right: 14px; border-radius: 4px; }
.wrong img { image-rendering: pixelated; width: 100%; max-width: 640px; display: block; margin: 8px 0; }
)css";

// What one cell tells: the worst of the checks of a port.
struct Cell {
    std::string_view shown;
    std::string text, title;
};

Cell cellOf(const StressResult& result, const std::string& port) {
    Cell cell;
    for (const StressCheck& check : result.checks) {
        if (check.port != port) continue;
        const std::string_view seen = !check.held ? "missed" : !check.limit.empty() ? "limit" : "held";
        const bool worse = cell.shown.empty() || (cell.shown == "held" && seen != "held") ||
                           (cell.shown == "limit" && seen == "missed");
        if (worse) cell.shown = seen;
        if (!check.held) cell.text = "×";
        const std::string why = !check.limit.empty() ? check.limit : check.what;
        const bool compared =
            check.expects != "finite" && check.expects != "energy" && std::isfinite(check.missed);
        cell.title += fmt::format("{}{}{}{}", cell.title.empty() ? "" : "; ", check.expects,
                                  compared ? fmt::format(" {:.2f} of what is allowed", check.missed) : "",
                                  why.empty() ? "" : ": " + why);
    }
    return cell;
}

std::string tableOf(const std::vector<StressResult>& results, const std::vector<std::string>& ports) {
    std::string html = "<div class=\"scroll\"><table class=\"cases\"><thead><tr><th>case</th>";
    for (const std::string& port : ports) html += fmt::format("<th>{}</th>", htmlText(port));
    html += "</tr></thead>\n<tbody>\n";
    for (const StressResult& result : results) {
        const bool bad = isBad(result.outcome);
        const std::string name = htmlText(result.name);
        html +=
            fmt::format("<tr><th>{}</th>", bad ? fmt::format("<a href=\"#{}\">{}</a>", name, name) : name);
        if (result.checks.empty()) {
            html += fmt::format("<td class=\"{}\" colspan=\"{}\" title=\"{}\">{}</td>",
                                bad ? "missed" : "lacking", std::max<size_t>(1, ports.size()),
                                htmlText(result.why), stressOutcomeName(result.outcome));
        } else {
            for (const std::string& port : ports) {
                const Cell cell = cellOf(result, port);
                html += fmt::format("<td class=\"{}\" title=\"{}\">{}</td>", cell.shown, htmlText(cell.title),
                                    cell.text);
            }
        }
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

std::string wrongOf(const StressResult& result) {
    std::string does;
    for (const StressCase& one : stressCases())
        if (one.name == result.name) does = one.does;
    std::string html = fmt::format("<div class=\"card wrong\" id=\"{0}\"><h3>{0} <span>{1}</span></h3>\n",
                                   htmlText(result.name), htmlText(does));
    if (!result.why.empty())
        html +=
            fmt::format("<p class=\"failed\">{}: {}{}</p>\n", stressOutcomeName(result.outcome),
                        htmlText(result.why), result.where.empty() ? "" : ", in " + htmlText(result.where));
    for (const StressCheck& check : result.checks) {
        if (check.held) continue;
        html += fmt::format("<p class=\"failed\">{}</p>\n", htmlText(check.what));
        if (!check.picture.empty())
            html += fmt::format("<a href=\"{0}\"><img src=\"{0}\" alt=\"{1}, as it should be and as it is\" "
                                "loading=\"lazy\"></a>\n",
                                htmlText(check.picture), htmlText(check.port));
    }
    return html + fmt::format("<div class=\"command\"><pre>{}</pre></div></div>\n", htmlText(result.command));
}

} // namespace

std::string stressPage(const StressRunInfo& info, const std::vector<StressResult>& results) {
    std::vector<std::string> ports;
    std::map<std::string_view, int> counts;
    for (const StressResult& result : results) {
        ++counts[stressOutcomeName(result.outcome)];
        for (const StressCheck& check : result.checks)
            if (std::ranges::find(ports, check.port) == ports.end()) ports.push_back(check.port);
    }
    std::ranges::sort(ports);
    const std::string graph = std::filesystem::path(info.graph).filename().string();
    std::string body =
        fmt::format("<div id=\"page\">\n<h1>{} under stress</h1>\n<div class=\"facts\">", htmlText(graph));
    const auto fact = [&](std::string_view name, const std::string& value) {
        body += fmt::format("<span>{} <b>{}</b></span>", name, htmlText(value));
    };
    fact("graph", info.graph);
    fact("scene", info.scene);
    fact("size", info.size);
    fact("renderer", info.renderer);
    for (const auto& [outcome, count] : counts) fact(outcome, std::to_string(count));
    body += "</div>\n<p class=\"key\"><span class=\"held\">held</span><span class=\"limit\">missed within a "
            "limit of the "
            "method</span><span class=\"missed\">missed</span></p>\n";
    body += tableOf(results, ports);
    std::string wrong;
    for (const StressResult& result : results)
        if (isBad(result.outcome)) wrong += wrongOf(result);
    if (!wrong.empty())
        body += fmt::format(
            "<h2>What was missed</h2>\n<p class=\"soft\">Pictures: as it should be on the left, as it is on "
            "the right; what is no number is magenta.</p>\n<div class=\"plots\">{}</div>\n",
            wrong);
    return page::document(graph + " under stress", style, body + "</div>\n");
}

} // namespace kestrel
