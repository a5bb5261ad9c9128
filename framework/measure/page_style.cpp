#include "measure/page_html.h"

namespace kestrel::page {

// Colours of series: eight hues that stay apart for most colour-blind eyes (after Okabe and Ito 2008), in a
// darker set on light and a lighter one on dark ground.
const std::string_view style = R"css(:root {
  --ground: #fbfbfa; --card: #ffffff; --ink: #1c1e21; --soft: #5d636b; --line: #d9dce0; --grid: #eceef0;
  --accent: #0b62a8; --shade: rgba(20, 25, 30, .07);
  --s0: #0072b2; --s1: #c8500a; --s2: #00835f; --s3: #a83279; --s4: #8a6d00; --s5: #5b52c4; --s6: #b3261e;
  --s7: #3f6f7d;
}
@media (prefers-color-scheme: dark) {
  :root {
    --ground: #14161a; --card: #1c1f24; --ink: #e8eaed; --soft: #9aa2ad; --line: #343a42; --grid: #282d34;
    --accent: #6cb6f5; --shade: rgba(0, 0, 0, .35);
    --s0: #56b4e9; --s1: #f0894d; --s2: #3fcf9f; --s3: #e58cc0; --s4: #e3c545; --s5: #a7a1ff; --s6: #ff8a80;
    --s7: #8fc4d4;
  }
}
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0; background: var(--ground); color: var(--ink);
  font: 15px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", sans-serif; }
#page { max-width: 1280px; margin: 0 auto; padding: 28px 24px 80px; }
h1 { font-size: 26px; line-height: 1.25; margin: 0 0 6px; letter-spacing: -.01em; }
h2 { font-size: 19px; margin: 40px 0 12px; }
h3 { font-size: 15px; margin: 0 0 6px; }
p { margin: 0 0 10px; max-width: 78ch; }
.soft { color: var(--soft); }
code, pre { font: 12.5px/1.45 ui-monospace, "SF Mono", Menlo, Consolas, "DejaVu Sans Mono", monospace; }
.note { border-left: 3px solid var(--accent); background: var(--card); padding: 10px 14px; margin: 14px 0;
  border-radius: 0 8px 8px 0; }
.note p { max-width: none; }
.note p:last-child { margin: 0; }
.facts { display: flex; flex-wrap: wrap; gap: 4px 22px; margin: 12px 0; font-size: 13.5px; color: var(--soft); }
.facts b { color: var(--ink); font-weight: 600; }
.controls { position: sticky; top: 0; z-index: 5; display: flex; flex-wrap: wrap; gap: 10px 18px; align-items: center;
  background: var(--ground); padding: 10px 0; border-bottom: 1px solid var(--line); font-size: 14px; }
.controls label { display: inline-flex; gap: 6px; align-items: center; color: var(--soft); }
select, button, input[type=search] { font: inherit; color: var(--ink); background: var(--card);
  border: 1px solid var(--line); border-radius: 7px; padding: 4px 9px; }
button { cursor: pointer; }
button:hover, select:hover { border-color: var(--accent); }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 1px; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(560px, 100%), 1fr)); gap: 20px; }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 12px; padding: 14px 16px;
  box-shadow: 0 1px 3px var(--shade); min-width: 0; }
.card h3 span { font-weight: 400; color: var(--soft); }
svg.plot { display: block; width: 100%; height: auto; overflow: visible; }
svg.plot text { fill: var(--soft); font-size: 12px; }
svg.plot .title { fill: var(--ink); }
svg.plot .grid { stroke: var(--grid); stroke-width: 1; }
svg.plot .fine { stroke: var(--grid); stroke-width: .5; }
svg.plot .frame { fill: none; stroke: var(--line); }
svg.plot .front { fill: none; stroke: var(--ink); stroke-width: 1.5; stroke-dasharray: 5 4; opacity: .65; }
svg.plot .noise { stroke: var(--soft); stroke-width: 1; stroke-dasharray: 2 3; }
svg.plot .series { fill: none; stroke-width: 1.6; opacity: .55; }
svg.plot .whisker { stroke-width: 1.2; opacity: .6; }
svg.plot .point { stroke: var(--card); stroke-width: 1.5; cursor: pointer; }
svg.plot .point.best { stroke: var(--ink); }
svg.plot .point:hover, svg.plot .point:focus { stroke: var(--ink); stroke-width: 2.5; outline: none; }
svg.plot .tag { fill: var(--ink); font-size: 11px; paint-order: stroke; stroke: var(--card); stroke-width: 3px;
  pointer-events: none; }
svg.plot .dim { opacity: .12; }
.legend { display: flex; flex-wrap: wrap; gap: 3px 14px; margin-top: 8px; font-size: 13px; }
.legend span { display: inline-flex; gap: 6px; align-items: center; cursor: default; }
.legend i { width: 11px; height: 11px; border-radius: 50%; display: inline-block; }
#tip { position: fixed; z-index: 20; pointer-events: none; display: none; max-width: 340px; background: var(--card);
  border: 1px solid var(--line); border-radius: 9px; padding: 9px 12px; font-size: 13px;
  box-shadow: 0 6px 24px var(--shade); }
#tip b { display: block; margin-bottom: 3px; }
#tip table { border-collapse: collapse; } #tip td { padding: 0 10px 0 0; font-variant-numeric: tabular-nums; }
#tip img { display: block; width: 100%; max-width: 300px; margin-top: 7px; border-radius: 5px; }
.scroll { overflow-x: auto; border: 1px solid var(--line); border-radius: 12px; background: var(--card); }
table.rows { border-collapse: collapse; width: 100%; font-size: 13px; font-variant-numeric: tabular-nums; }
table.rows th { text-align: right; font-weight: 600; padding: 0; border-bottom: 1px solid var(--line);
  white-space: nowrap; background: var(--card); }
table.rows th button { all: unset; cursor: pointer; padding: 8px 10px; display: block; width: 100%;
  box-sizing: border-box; }
table.rows th button:hover { color: var(--accent); }
table.rows th button:focus-visible { outline: 2px solid var(--accent); outline-offset: -2px; }
table.rows th[aria-sort=ascending] button::after { content: " \2191"; }
table.rows th[aria-sort=descending] button::after { content: " \2193"; }
table.rows th > span { padding: 8px 10px; display: block; }
table.rows td { text-align: right; padding: 5px 10px; border-bottom: 1px solid var(--grid); white-space: nowrap; }
table.rows .word { text-align: left; }
table.rows tbody tr:hover td { background: var(--grid); }
table.rows tr.best td:first-child { box-shadow: inset 3px 0 var(--accent); }
table.rows a { color: inherit; text-decoration-color: var(--line); text-underline-offset: 3px; }
table.ranks { border-collapse: collapse; font-size: 13px; }
table.ranks td { padding: 2px 14px 2px 0; }
table.ranks tr:first-child { color: var(--soft); }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(380px, 100%), 1fr)); gap: 16px; }
.pictures .pair { display: grid; grid-template-columns: 1fr 1fr; gap: 6px; margin: 8px 0; }
.pictures .pair.one { grid-template-columns: 1fr; }
.pictures img { width: 100%; height: auto; display: block; border-radius: 6px; background: var(--grid); }
.pictures figcaption { font-size: 12px; color: var(--soft); margin-top: 2px; }
.pictures figure { margin: 0; }
.command { display: flex; gap: 6px; align-items: flex-start; margin-top: 6px; }
.command pre { margin: 0; flex: 1; min-width: 0; white-space: pre-wrap; overflow-wrap: anywhere; background: var(--ground);
  border: 1px solid var(--grid); border-radius: 7px; padding: 6px 9px; }
.command button { font-size: 12px; padding: 3px 8px; }
details summary { cursor: pointer; color: var(--soft); font-size: 13px; margin-top: 6px; }
details table { border-collapse: collapse; font-size: 12.5px; margin-top: 4px; }
details td { padding: 1px 12px 1px 0; font-variant-numeric: tabular-nums; }
.failed { color: var(--s6); }
.swatch { display: inline-block; width: 10px; height: 10px; border-radius: 50%; margin-right: 7px; }
@media print { .controls, .command button { display: none; } .card { break-inside: avoid; } }
)css";

} // namespace kestrel::page
