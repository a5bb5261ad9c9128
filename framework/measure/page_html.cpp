#include "measure/page_html.h"
#include <fmt/format.h>

namespace kestrel::page {

std::string htmlText(std::string_view text) {
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

std::string document(std::string_view title, std::string_view more, std::string_view body) {
    return fmt::format(R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{}</title>
<link rel="icon" href="data:,">
<style>
{}{}</style>
</head>
<body>
{}</body>
</html>
)",
                       htmlText(title), style, more, body);
}

} // namespace kestrel::page
