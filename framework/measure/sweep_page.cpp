#include "measure/sweep_page.h"
#include "measure/page_html.h"
#include "measure/sweep_results.h"
#include <fmt/format.h>

namespace kestrel {
namespace {

// JSON that stands in a script element: nothing in it may end the element or open a comment.
std::string scriptJson(const std::string& json) {
    std::string escaped;
    for (const char c : json) escaped += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return escaped;
}

} // namespace

std::string resultsPage(const Sweep& sweep, const SweepResults& results) {
    return page::document(
        sweep.title, "",
        fmt::format(
            R"(<div id="page"><noscript>This page draws its plots with JavaScript; the same numbers stand in results.csv and
results.json beside it.</noscript></div>
<script type="application/json" id="results">
{}</script>
<script>
{}{}{}{}</script>
)",
            scriptJson(resultsJson(sweep, results)), page::plotScript, page::splitScript, page::tuneScript,
            page::tableScript));
}

} // namespace kestrel
