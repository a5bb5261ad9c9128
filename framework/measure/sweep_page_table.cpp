#include "measure/sweep_page.h"

namespace kestrel::page {

const std::string_view tableScript = R"js(
// ---- table
const number = (title, value, text, hint) => ({ title, value, text: text || (r => digits(value(r))), hint });
const some = f => rows.some(r => finite(f(r)));
const columns = [
  { title: 'scene', word: true, value: r => r.scene, text: r => r.scene },
  { title: 'variant', word: true, value: r => r.variant, text: r => r.variant },
  ...(manyMachines ? [{ title: 'machine', word: true, value: r => r.machine, text: r => r.machine }] : []),
  ...timeNames.filter(t => ['total', 'generation', 'tracing', 'filter', ...R.times].includes(t))
    .map(t => number(t + ' ms', r => timeOf(r, t), null, 'median of ' + t + ' over all timed frames')),
  number('± ms', r => r.ms_q3.total === undefined ? null : (r.ms_q3.total - r.ms_q1.total) / 2, null, 'half the distance of the quartiles of total'),
  number('ns a ray', r => r.rays ? r.rays.tracing_ns : null, null, 'tracing'),
  number('FLIP', r => r.flip), number('RMSE', r => r.mse === null ? null : Math.sqrt(r.mse)), number('PSNR', r => r.psnr, r => finite(r.psnr) ? r.psnr.toFixed(1) : r.flip === 0 ? '∞' : '–'),
  number('SSIM', r => r.ssim, r => finite(r.ssim) ? r.ssim.toFixed(4) : '–'),
  number('agrees %', r => r.rays ? 100 * r.rays.agreement : null, r => r.rays ? (100 * r.rays.agreement).toFixed(2) : '–', 'rays that hit or miss as the reference’s'),
  number('memory', r => r.memory, r => bytes(r.memory)),
  number('compile ms', r => r.compile_ms, null, 'of the graph, without shaders'),
  number('left out', r => r.left_out_count, r => String(r.left_out_count), 'passes and parts that were not needed'),
  number('frames', r => r.repeat_count, r => String(r.repeat_count), 'timed frames'),
].filter(c => c.word || some(c.value));
const tableHead = make('tr', {}), tableBody = make('tbody', {}), table = make('table', { class: 'rows', id: 'rows' }, make('thead', {}, tableHead), tableBody);
function visibleRows() {
  const find = state.find.toLowerCase();
  return rows.filter(r => (!state.scene || r.scene === state.scene) && (r.variant + ' ' + r.scene + ' ' + r.series).toLowerCase().includes(find));
}
function compare(a, b, column) {
  const u = column.value(a), v = column.value(b);
  if (column.word) return String(u).localeCompare(String(v), 'en', { numeric: true });
  if (!finite(u) || !finite(v)) return finite(u) ? -Infinity : finite(v) ? Infinity : 0;  // nothing comes last, up or down
  return u - v;
}
function drawTable() {
  tableHead.replaceChildren(...columns.map((c, i) => make('th', { class: c.word ? 'word' : null, scope: 'col',
    'aria-sort': state.sort === i ? (state.down ? 'descending' : 'ascending') : 'none' },
    make('button', { title: c.hint, onclick: () => {
      state.down = state.sort === i ? !state.down : false;
      state.sort = i;
      drawTable();
    } }, c.title))));
  const shown = visibleRows();
  if (state.sort !== null) {
    const column = columns[state.sort];
    shown.sort((a, b) => {
      const order = compare(a, b, column);
      return (Number.isFinite(order) && state.down ? -order : Math.sign(order)) || a.index - b.index;
    });
  }
  tableBody.replaceChildren(...shown.map(r => make('tr', { class: r.pareto ? 'best' : null, 'data-row': r.index },
    columns.map(c => c.title === 'variant'
      ? make('td', { class: 'word' }, make('span', { class: 'swatch', style: 'background:' + colour(r) }),
        make('a', { href: '#row' + r.index }, r.variant), r.failed ? make('span', { class: 'failed' }, ' failed') : '')
      : make('td', { class: c.word ? 'word' : null }, r.failed && !c.word ? '–' : c.text(r))))));
}

// ---- pictures
function command(text) {
  const button = make('button', { onclick: async () => {
    try { await navigator.clipboard.writeText(text); button.textContent = 'copied'; }
    catch (e) {
      const range = document.createRange();
      range.selectNodeContents(pre);
      getSelection().removeAllRanges();
      getSelection().addRange(range);
      button.textContent = 'selected';
    }
    setTimeout(() => { button.textContent = 'copy'; }, 1500);
  } }, 'copy');
  const pre = make('pre', {}, text);
  return make('div', { class: 'command' }, pre, button);
}
function figure(file, caption) {
  return make('figure', {}, make('a', { href: file }, make('img', { src: file, alt: caption, loading: 'lazy',
    width: R.size[0], height: R.size[1] })), make('figcaption', {}, caption));
}
function details(r) {
  const lines = r.steps.map(s => [s.step, digits(s.ms) + ' ms', digits(s.q1) + ' to ' + digits(s.q3)]);
  const more = [['memory that stays', bytes(r.memory_persistent), ''], ['memory of a frame', bytes(r.memory_transient), 'without sharing ' + bytes(r.memory_unshared)],
    ['compiling the graph', digits(r.compile_ms) + ' ms', ''], ['until the first frame was there', digits(r.set_up_ms) + ' ms', ''],
    ...Object.entries(r.reports).map(([k, v]) => [k, digits(v, 5), '']),
    ...r.left_out.map(l => ['left out: ' + l.what, l.why, ''])];
  return make('details', {}, make('summary', {}, 'steps, memory, what was left out'),
    make('table', {}, [...lines, ...more].map(l => make('tr', {}, l.map(t => make('td', {}, t))))));
}
const pictureArea = make('div', {});
function drawPictures() {
  const parts = [];
  for (const scene of R.scenes) {
    if (state.scene && scene.name !== state.scene) continue;
    const own = visibleRows().filter(r => r.scene === scene.name);
    if (!own.length) continue;
    const cards = [];
    if (scene.reference)
      cards.push(make('div', { class: 'card' }, make('h3', {}, 'Reference'), make('div', { class: 'pair one' }, figure(scene.reference,
        finite(scene.reference_noise) ? 'its noise (RMSE): ' + digits(scene.reference_noise) : 'its noise is not known'))));
    for (const r of own) {
      const caption = r.kind === 'rays' ? digits(100 * (r.rays ? r.rays.agreement : NaN), 4) + ' % of ' + (r.rays ? r.rays.count : 0) + ' rays agree'
        : 'FLIP ' + digits(r.flip) + ', ' + digits(timeOf(r, state.time)) + ' ms (' + state.time + ')';
      cards.push(make('div', { class: 'card', id: 'row' + r.index }, make('h3', {}, make('span', { class: 'swatch', style: 'background:' + colour(r) }), r.variant),
        r.failed ? make('p', { class: 'failed' }, r.failed)
          : r.picture ? make('div', { class: 'pair' }, figure(r.picture, caption), r.heat_map ? figure(r.heat_map, 'FLIP error') : make('p', { class: 'soft' }, 'no pixel counts: the mask is 0 everywhere')) : make('p', { class: 'soft' }, caption),
        r.failed ? '' : details(r), command(r.command), make('details', {}, make('summary', {}, 'measure its times again'), command(r.times_command))));
    }
    parts.push(make('h2', {}, 'Pictures: ' + scene.name), make('div', { class: 'pictures' }, cards));
  }
  pictureArea.replaceChildren(...parts);
}

// ---- the page
function select(title, values, current, set) {
  return make('label', {}, title, make('select', { onchange: e => set(e.target.value) },
    values.map(([value, text]) => make('option', { value, selected: value === current }, text))));
}
function header() {
  const failed = rows.filter(r => r.failed).length;
  const spin = m => m.spin.one_thread_ms.max > 0
    ? `spin test: one thread ${digits(m.spin.one_thread_ms.median)} ms (${digits(m.spin.one_thread_ms.min)} to ${digits(m.spin.one_thread_ms.max)}), `
      + `two at once ${digits(m.spin.two_threads_ms.median)} ms (${digits(m.spin.two_threads_ms.min)} to ${digits(m.spin.two_threads_ms.max)})` : '';
  return [
    make('h1', {}, R.title), R.comment ? make('p', { class: 'soft' }, R.comment) : '',
    make('div', { class: 'facts' },
      [['size', R.size.join(' × ')], ['pictures after', R.frames + (R.frames === 1 ? ' frame' : ' frames')],
        ['timed', `${R.repeats} repetitions of ${R.timed_frames}, in turn with all others`],
        ['each timed frame', R.rebuild ? 'builds everything anew' : 'goes on from the last'],
        ['kestrel', R.version + ' ' + R.configuration], ['results', rows.length - failed + (failed ? `, ${failed} failed` : '')]]
        .map(([k, v]) => make('span', {}, k + ' ', make('b', {}, v)))),
    make('div', { class: 'note' },
      manyMachines ? make('p', {}, make('b', {}, `Measured on ${R.machines.length} machines. `),
        'Times compare only within one machine: each has its own marker and its own Pareto front.') : '',
      R.machines.map((m, i) => make('p', {}, manyMachines ? make('b', {}, `${m.id} (${shapes[i % shapes.length]}) `) : '',
        `${m.cpu}, ${m.threads} threads; ${m.renderer}; ${m.driver}; clock: ${m.clock}. `, make('span', { class: 'soft' }, spin(m))))),
    R.missing.length ? make('div', { class: 'note' }, make('p', {}, make('b', {}, `Not measured yet (${R.missing.length}): `),
      R.missing.slice(0, 12).join('; ') + (R.missing.length > 12 ? '; …' : ''))) : '',
  ];
}
function controls() {
  const times = [...timeNames, ...(rows.some(r => r.rays) ? ['ns a ray'] : []), 'memory'];
  return make('div', { class: 'controls' },
    select('time', times.map(t => [t, timeTitle(t)]), state.time, v => { state.time = v; drawPlots(); drawPictures(); }),
    rows.some(r => r.kind === 'picture') ? select('error', Object.entries(errors).map(([k, v]) => [k, v[0]]), state.error, v => { state.error = v; drawPlots(); }) : '',
    R.scenes.length > 1 ? select('scene', [['', 'all'], ...R.scenes.map(s => [s.name, s.name])], state.scene, v => { state.scene = v; drawAll(); }) : '',
    make('label', {}, make('input', { type: 'checkbox', onchange: e => { state.labels = e.target.checked; drawPlots(); } }), 'names of all points'),
    make('label', {}, 'find ', make('input', { type: 'search', size: 14, oninput: e => { state.find = e.target.value; drawTable(); drawPictures(); } })));
}
function drawAll() { drawPlots(); drawTable(); drawPictures(); }
document.getElementById('page').replaceChildren(...[...header(), controls(),
  ...tuningParts(), make('h2', {}, 'Error against time'), make('p', { class: 'soft' }, 'Both axes are logarithmic; down and to the left is better. Points are medians, bars reach from the first to the third quartile.'),
  plotArea, make('h2', {}, 'Table'), make('p', { class: 'soft' }, 'Click a heading to sort by it; what is marked at its left is on the Pareto front of its plot.'),
  make('div', { class: 'scroll' }, table), ...splitParts(), pictureArea, tip].filter(e => e !== ''));
drawAll();
if (location.hash.length > 1) { const e = document.getElementById(location.hash.slice(1)); if (e) e.scrollIntoView(); }

// ---- index.html?selftest: the page tries itself out and says what it found.
if (new URLSearchParams(location.search).has('selftest')) {
  const found = { points: plotArea.querySelectorAll('.point').length, rows: tableBody.children.length, sorted: 0, unsorted: [], pictures: pictureArea.querySelectorAll('img').length };
  columns.forEach((column, i) => {
    for (const sign of [1, -1]) {
      tableHead.children[i].firstChild.click();
      const shown = [...tableBody.children].map(tr => rows[tr.dataset.row]);
      const good = shown.every((r, k) => {
        if (!k) return true;
        const order = compare(shown[k - 1], r, column);
        return order === 0 || order === -Infinity || sign * order < 0;
      });
      if (good && shown.length === rows.length) found.sorted += 1; else found.unsorted.push(column.title);
    }
  });
  state.sort = null; drawTable();
  // The front of the sweep's own axes is known from where it was measured.
  const best = new Set([...plotArea.querySelectorAll('.point.best')].map(e => Number(e.dataset.row)));
  found.front = rows.every(r => r.pareto === best.has(r.index));
  for (const menu of document.querySelectorAll('.controls select')) {
    const before = menu.value;
    for (const option of menu.options) { menu.value = option.value; menu.dispatchEvent(new Event('change')); }
    menu.value = before; menu.dispatchEvent(new Event('change'));
  }
  document.querySelectorAll('.point').forEach(e => e.dispatchEvent(new MouseEvent('mousemove', { clientX: 5, clientY: 5 })));
  hideTip();
  found.errors = mistakes;
  document.documentElement.dataset.selftest = JSON.stringify(found);
}
})();
)js";

} // namespace kestrel::page
