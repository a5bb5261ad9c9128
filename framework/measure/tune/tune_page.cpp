#include "measure/sweep_page.h"

namespace kestrel::page {

const std::string_view tuneScript = R"js(
// ---- what `kestrel tune` found
function tuningParts() {
  const T = R.tuning;
  if (!T) return [];
  const name = rows.some(r => r.kind === 'rays') ? 'disagreement' : errors[R.plot.error][0];
  const percent = (before, after) => finite(before) && finite(after) && before > 0
    ? (after <= before ? '−' : '+') + digits(100 * Math.abs(after - before) / before, 2) + ' %' : '–';
  const grid = (head, body) => make('div', { class: 'scroll' }, make('table', { class: 'rows' },
    make('thead', {}, make('tr', {}, head.map(([text, word]) => make('th', { class: word ? 'word' : null, scope: 'col' }, make('span', {}, text))))),
    make('tbody', {}, body.map(cells => make('tr', {}, cells.map((cell, i) => make('td', { class: head[i][1] ? 'word' : null }, cell)))))));
  const found = grid([['variant', true], ['found', true], [name + ', default'], ['tuned'], ['change'], ['held out, default'], ['tuned'], ['change'],
    ['time, of the default’s'], ['settings tried'], ['better but too slow']],
    T.points.map(p => [p.variant, p.set.filter((s, i) => s !== p.start[i]).join('  ') || 'the default stands',
      digits(p.start_error), digits(p.error), percent(p.start_error, p.error), digits(p.held_out_start_error), digits(p.held_out_error),
      percent(p.held_out_start_error, p.held_out_error), digits(p.time_ratio), String(p.asked), String(p.too_slow)]));
  const ranks = T.ranks.map(plot => make('div', { class: 'card' },
    make('h3', {}, plot.scene, make('span', {}, (plot.plot ? ' · ' + plot.plot : '')
      + (plot.held_out ? ' · held out' : plot.trained ? ' · trained on' : '') + (plot.changed ? '' : ' · ranks stay'))),
    make('table', { class: 'ranks' }, make('tr', {}, make('td', {}), make('td', {}, 'at defaults'), make('td', {}, 'tuned')),
      plot.default.map((was, i) => {
        const now = plot.tuned[i], from = plot.default.indexOf(now);
        return make('tr', {}, make('td', {}, String(i + 1)), make('td', {}, was),
          make('td', {}, now + (from > i ? ` ↑${from - i}` : from < i ? ` ↓${i - from}` : '')));
      }))));
  return [make('h2', {}, 'Default and tuned'),
    make('p', { class: 'soft' }, `Tuned on ${T.train.join(', ')}` + (T.hold_out.length ? `; held out: ${T.hold_out.join(', ')}. ` : '. ')
      + (finite(T.most_ms) ? `At most ${T.most_ms} ms a training scene. ` : `At most ${T.most_time} times the default’s time. `)
      + `${T.defaults_within_5_percent} of ${T.points.length} defaults are within 5 % of their tuned error. `
      + `Tuning changed the ranks of ${T.held_out_plots_changed} of ${T.held_out_plots} plots that were held out. In the plots defaults are hollow, and a line leads to what was found.`),
    found, make('h2', {}, 'Ranks by ' + name), make('div', { class: 'plots' }, ranks)];
}
)js";

} // namespace kestrel::page
