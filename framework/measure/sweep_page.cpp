#include "measure/sweep_page.h"
#include "measure/sweep_results.h"
#include <fmt/format.h>

namespace kestrel {
namespace {

std::string htmlText(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '&')
            escaped += "&amp;";
        else if (c == '<')
            escaped += "&lt;";
        else if (c == '>')
            escaped += "&gt;";
        else if (c == '"')
            escaped += "&quot;";
        else
            escaped += c;
    }
    return escaped;
}

// JSON that stands in a script element: nothing in it may end the element or open a comment.
std::string scriptJson(const std::string& json) {
    std::string escaped;
    for (const char c : json) escaped += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return escaped;
}

} // namespace

std::string resultsPage(const Sweep& sweep, const SweepResults& results) {
    return fmt::format(R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{}</title>
<link rel="icon" href="data:,">
<style>
{}</style>
</head>
<body>
<div id="page"><noscript>This page draws its plots with JavaScript; the same numbers stand in results.csv and
results.json beside it.</noscript></div>
<script type="application/json" id="results">
{}</script>
<script>
{}{}</script>
</body>
</html>
)",
                       htmlText(sweep.title), page::style, scriptJson(resultsJson(sweep, results)),
                       page::plotScript, page::tableScript);
}

} // namespace kestrel
