#include "measure/sweep_page.h"

namespace kestrel::page {

const std::string_view splitScript = R"js(
// ---- the error taken apart
const splitNames = [['representation', 'representation', '--s0'], ['algorithm', 'algorithm', '--s1'], ['cross', 'both together', '--s3'],
  ['sampling', 'its own noise', '--s4'], ['reference_noise', 'the reference’s noise', '--s7']];
// A bar from the parts above 0, one after the other, and to the left of 0 those below it.
function splitBar(split, most) {
  const w = 260, h = 16, low = splitNames.reduce((sum, [key]) => sum + Math.min(0, split[key]), 0);
  const scale = w / (most[1] - most[0]);
  const svg = draw('svg', { width: w, height: h, viewBox: `0 0 ${w} ${h}`, role: 'img', 'aria-label': 'parts of the error' });
  let right = 0, left = 0;
  for (const [key, title, hue] of splitNames) {
    const v = split[key], from = v >= 0 ? right : left + v;
    svg.append(draw('rect', { x: (from - most[0]) * scale, y: 1, width: Math.abs(v) * scale, height: h - 2, style: `fill:var(${hue})` },
      draw('title', {}, title + ' ' + digits(v))));
    if (v >= 0) right += v; else left += v;
  }
  svg.append(draw('line', { x1: -most[0] * scale, x2: -most[0] * scale, y1: 0, y2: h, style: 'stroke:var(--ink)' }));
  return svg;
}
function splitParts() {
  const apart = rows.filter(r => r.split);
  if (!apart.length) return [];
  const scenes = [...new Set(apart.map(r => r.scene))];
  return [make('h2', {}, 'The error taken apart'),
    make('p', { class: 'soft' }, 'Mean squares. Representation: exact tracing of the same map or field against the truth. Algorithm: the technique against that '
      + 'exact tracing. Both together: twice their mean product, below 0 where one makes up for the other. All are estimated from two independent halves, '
      + 'so that noise is in none of them but its own; the last column is what the parts add up to over the mean squared error.'),
    ...scenes.map(scene => {
      const own = apart.filter(r => r.scene === scene);
      const sum = (split, sign) => splitNames.reduce((total, [key]) => total + Math.max(0, sign * split[key]), 0);
      const most = [-Math.max(...own.map(r => sum(r.split, -1))), Math.max(...own.map(r => sum(r.split, 1)))];
      return make('div', { class: 'card' }, make('h3', {}, scene), make('div', { class: 'scroll' }, make('table', { class: 'rows' },
        make('thead', {}, make('tr', {}, ['variant', 'MSE', ...splitNames.map(n => n[1]), '', 'sum'].map((t, i) =>
          make('th', { class: i ? null : 'word', scope: 'col' }, make('span', {}, i > 1 && i < 7 ? make('i', { class: 'swatch', style: `background:var(${splitNames[i - 2][2]})` }) : '', t))))),
        make('tbody', {}, own.map(r => make('tr', {}, make('td', { class: 'word' }, r.variant), make('td', {}, digits(r.split.mse)),
          splitNames.map(([key]) => make('td', {}, digits(r.split[key]))), make('td', {}, splitBar(r.split, most)),
          make('td', {}, digits(100 * r.split.sum / r.split.mse) + ' %')))))));
    })];
}
)js";

} // namespace kestrel::page
