#include "measure/sweep_page.h"

namespace kestrel::page {

// No text of the results is ever taken for HTML: elements are made one by one, with textContent.
const std::string_view script = R"js((() => {
'use strict';
const R = JSON.parse(document.getElementById('results').textContent);
const SVG = 'http://www.w3.org/2000/svg';
const mistakes = [];
window.addEventListener('error', e => { mistakes.push(String(e.message)); });

// ---- small things
function make(tag, attributes, ...children) {
  const e = document.createElement(tag);
  return fill(e, attributes, children);
}
function draw(tag, attributes, ...children) {
  const e = document.createElementNS(SVG, tag);
  return fill(e, attributes, children);
}
function fill(e, attributes, children) {
  for (const [k, v] of Object.entries(attributes || {})) {
    if (v === null || v === undefined || v === false) continue;
    if (k.startsWith('on')) e.addEventListener(k.slice(2), v);
    else e.setAttribute(k, v === true ? '' : v);
  }
  for (const c of children.flat()) if (c !== null && c !== undefined && c !== '') e.append(c);
  return e;
}
const finite = v => typeof v === 'number' && Number.isFinite(v);
function digits(v, n = 3) {
  if (!finite(v)) return '–';
  if (v === 0) return '0';
  const a = Math.abs(v);
  if (a >= 1e5 || a < 1e-4) return v.toExponential(n - 1);
  return v.toFixed(Math.max(0, Math.min(8, n - 1 - Math.floor(Math.log10(a)))));
}
function bytes(v) {
  if (!finite(v)) return '–';
  const units = ['B', 'KiB', 'MiB', 'GiB'];
  let i = 0;
  for (; v >= 1024 && i < 3; ++i) v /= 1024;
  return (i ? v.toFixed(v < 10 ? 2 : 1) : v) + ' ' + units[i];
}
const rows = R.rows;
rows.forEach((row, i) => { row.index = i; });
const manyMachines = R.machines.length > 1;
const seriesNames = [...new Set(rows.map(r => r.series))];
const colour = row => 'var(--s' + seriesNames.indexOf(row.series) % 8 + ')';
const hollow = row => Math.floor(seriesNames.indexOf(row.series) / 8) % 2 === 1;

// ---- what the axes can show
const fixedTimes = ['total', 'generation', 'tracing', 'filter', 'frame'];
const timeNames = [...new Set([...R.times, ...fixedTimes.filter(t => rows.some(r => t in r.ms)),
  ...rows.flatMap(r => Object.keys(r.ms)).sort()])];
const timeOf = (row, name) => {
  if (name === 'ns a ray') return row.rays ? row.rays.tracing_ns : null;
  if (name === 'memory') return row.memory / 1048576;
  return row.ms[name] === undefined ? null : row.ms[name];
};
const timeTitle = name => name === 'ns a ray' ? 'tracing, ns a ray' : name === 'memory' ? 'memory, MiB'
  : name + ', ms';
const errors = {
  flip: ['FLIP (mean)', r => r.flip], mse: ['MSE', r => r.mse],
  rmse: ['RMSE', r => r.mse === null ? null : Math.sqrt(r.mse)],
  ssim: ['1 − SSIM', r => r.ssim === null ? null : 1 - r.ssim],
};
const disagreement = r => r.rays ? 1 - r.rays.agreement : null;
const errorOf = (row, name) => row.kind === 'rays' ? disagreement(row) : errors[name][1](row);
const errorTitle = (rays, name) => rays ? 'rays that hit or miss unlike the reference’s' : errors[name][0];

const state = {
  time: timeNames.includes(R.plot.time) ? R.plot.time : 'total', error: R.plot.error, labels: false, scene: '', find: '',
  sort: null, down: false,
};

// Indices of what nothing beats: in the order of rising time.
function pareto(points) {
  const order = points.map((p, i) => i).filter(i => finite(points[i][0]) && finite(points[i][1]));
  order.sort((a, b) => points[a][0] - points[b][0] || points[a][1] - points[b][1] || a - b);
  const front = [];
  for (const i of order) {
    const last = front.length ? points[front[front.length - 1]] : null;
    if (!last || points[i][1] < last[1] || (points[i][1] === last[1] && points[i][0] === last[0])) front.push(i);
  }
  return front;
}

// ---- tool tip
const tip = make('div', { id: 'tip', role: 'status' });
function showTip(row, event) {
  const lines = [[timeTitle(state.time), digits(timeOf(row, state.time))],
    ['quartiles', row.ms_q1[state.time] === undefined ? null
      : digits(row.ms_q1[state.time]) + ' to ' + digits(row.ms_q3[state.time])]];
  if (row.kind === 'rays')
    lines.push(['agrees', digits(100 * row.rays.agreement, 4) + ' %'], ['hits', digits(100 * row.rays.hit_share, 4) + ' %'],
      ['tracing', digits(row.rays.tracing_ns) + ' ns a ray']);
  else lines.push(['FLIP', digits(row.flip)], ['RMSE', digits(Math.sqrt(row.mse))], ['SSIM', digits(row.ssim, 4)]);
  lines.push(['memory', bytes(row.memory)]);
  if (manyMachines) lines.push(['machine', row.machine]);
  tip.replaceChildren(make('b', {}, row.variant), make('table', {},
    lines.filter(l => l[1] !== null).map(l => make('tr', {}, make('td', { class: 'soft' }, l[0]), make('td', {}, l[1])))));
  if (row.picture) tip.append(make('img', { src: row.picture, alt: '' }));
  tip.style.display = 'block';
  const box = tip.getBoundingClientRect();
  tip.style.left = Math.max(8, Math.min(event.clientX + 16, innerWidth - box.width - 12)) + 'px';
  tip.style.top = Math.max(8, Math.min(event.clientY + 14, innerHeight - box.height - 12)) + 'px';
}
const hideTip = () => { tip.style.display = 'none'; };

// ---- plots
const W = 620, H = 400, left = 66, right = 16, top = 14, bottom = 50;
function logTicks(low, high) {
  const major = [], minor = [];
  for (let e = Math.floor(low) - 1; e <= Math.ceil(high); ++e)
    for (let m = 1; m < 10; ++m) {
      const t = e + Math.log10(m);
      if (t >= low - 1e-9 && t <= high + 1e-9) (m === 1 ? major : minor).push([t, m * 10 ** e, m]);
    }
  return { major, minor };
}
function tickText(v) {
  if (v >= 1e5 || v < 1e-3) {
    const e = Math.floor(Math.log10(v) + 1e-9);
    return Math.round(v / 10 ** e) + 'e' + e;
  }
  return String(Number(v.toPrecision(1)));
}
function range(values) {
  let low = Math.min(...values.map(Math.log10)), high = Math.max(...values.map(Math.log10));
  if (high - low < 0.4) { const middle = (low + high) / 2; low = middle - 0.2; high = middle + 0.2; }
  const margin = 0.07 * (high - low);
  return [low - margin, high + margin];
}
const shapes = ['circle', 'square', 'diamond', 'triangle'];
function marker(shape, x, y, r) {
  if (shape === 'square') return draw('rect', { x: x - r, y: y - r, width: 2 * r, height: 2 * r });
  if (shape === 'diamond') return draw('path', { d: `M${x} ${y - 1.3 * r}L${x + 1.3 * r} ${y}L${x} ${y + 1.3 * r}L${x - 1.3 * r} ${y}Z` });
  if (shape === 'triangle') return draw('path', { d: `M${x} ${y - 1.2 * r}L${x + 1.2 * r} ${y + r}L${x - 1.2 * r} ${y + r}Z` });
  return draw('circle', { cx: x, cy: y, r });
}
const axisNumber = label => { const n = parseFloat(label); return Number.isNaN(n) ? 0 : n; };

function plot(group) {
  const rays = group.rows[0].kind === 'rays';
  const svg = draw('svg', { class: 'plot', viewBox: `0 0 ${W} ${H}`, role: 'img',
    'aria-label': 'Error against time, ' + group.title });
  let points = group.rows.map(row => ({ row, t: timeOf(row, state.time), e: errorOf(row, state.error) }))
    .filter(p => finite(p.t) && finite(p.e) && p.t > 0);
  const positive = points.filter(p => p.e > 0);
  if (!points.length) {
    svg.append(draw('text', { x: W / 2, y: H / 2, 'text-anchor': 'middle' }, 'Nothing here has this time and this error.'));
    return svg;
  }
  const [tLow, tHigh] = range(points.map(p => p.t));
  const [eLow, eHigh] = positive.length ? range(positive.map(p => p.e)) : [-1, 0];
  const zeros = positive.length < points.length;
  const floor = H - bottom - (zeros ? 22 : 0);  // no error at all lies below the axis' end
  const x = t => left + (Math.log10(t) - tLow) / (tHigh - tLow) * (W - left - right);
  const y = e => e > 0 ? floor - (Math.log10(e) - eLow) / (eHigh - eLow) * (floor - top) : H - bottom;
  const tTicks = logTicks(tLow, tHigh), eTicks = logTicks(eLow, eHigh);
  for (const [t] of tTicks.minor) { const u = x(10 ** t); svg.append(draw('line', { class: 'fine', x1: u, x2: u, y1: top, y2: H - bottom })); }
  for (const [t] of eTicks.minor) { const v = y(10 ** t); svg.append(draw('line', { class: 'fine', x1: left, x2: W - right, y1: v, y2: v })); }
  // Where a decade has no end in view, the numbers between carry text.
  const named = ticks => {
    if (ticks.major.length > 2) return ticks.major;
    const all = [...ticks.major, ...ticks.minor].sort((a, b) => a[0] - b[0]);
    return all.length <= 6 ? all : all.filter(t => [1, 2, 5].includes(t[2]));
  };
  for (const [t, v] of named(tTicks)) {
    const u = x(10 ** t);
    svg.append(draw('line', { class: 'grid', x1: u, x2: u, y1: top, y2: H - bottom }),
      draw('text', { x: u, y: H - bottom + 18, 'text-anchor': 'middle' }, tickText(v)));
  }
  for (const [t, v] of named(eTicks)) {
    const w = y(10 ** t);
    svg.append(draw('line', { class: 'grid', x1: left, x2: W - right, y1: w, y2: w }),
      draw('text', { x: left - 8, y: w + 4, 'text-anchor': 'end' }, tickText(v)));
  }
  if (zeros) svg.append(draw('text', { x: left - 8, y: H - bottom + 4, 'text-anchor': 'end' }, '0'));
  svg.append(draw('rect', { class: 'frame', x: left, y: top, width: W - left - right, height: H - top - bottom }),
    draw('text', { class: 'title', x: (left + W - right) / 2, y: H - 10, 'text-anchor': 'middle' }, timeTitle(state.time)),
    draw('text', { class: 'title', x: 0, y: 0, 'text-anchor': 'middle', transform: `translate(15 ${(top + H - bottom) / 2}) rotate(-90)` },
      errorTitle(rays, state.error)));
  const noise = noiseOf(group);
  if (!rays && finite(noise) && noise > 0 && Math.log10(noise) > eLow && Math.log10(noise) < eHigh)
    svg.append(draw('line', { class: 'noise', x1: left, x2: W - right, y1: y(noise), y2: y(noise) }),
      draw('text', { x: W - right - 6, y: y(noise) - 5, 'text-anchor': 'end' }, 'noise of the reference'));

  // Points of one series, machine by machine, joined along its axis.
  const bySeries = new Map();
  for (const p of points) {
    const key = p.row.series + '\n' + p.row.machine;
    if (!bySeries.has(key)) bySeries.set(key, []);
    bySeries.get(key).push(p);
  }
  for (const list of bySeries.values()) {
    const along = list[0].row.along;
    const chains = new Map();
    for (const p of list) {
      const rest = JSON.stringify(Object.entries(p.row.axes).filter(([k]) => k !== along));
      if (!chains.has(rest)) chains.set(rest, []);
      chains.get(rest).push(p);
    }
    for (const chain of chains.values()) {
      chain.sort((a, b) => axisNumber(a.row.axes[along]) - axisNumber(b.row.axes[along]));
      if (chain.length > 1)
        svg.append(draw('path', { class: 'series', 'data-series': list[0].row.series, style: 'stroke:' + colour(list[0].row),
          d: chain.map((p, i) => (i ? 'L' : 'M') + x(p.t).toFixed(1) + ' ' + y(p.e).toFixed(1)).join('') }));
    }
  }
  // The front: what is reached at each time, one a machine.
  for (const machine of new Set(points.map(p => p.row.machine))) {
    const own = points.filter(p => p.row.machine === machine);
    const front = pareto(own.map(p => [p.t, p.e])).map(i => own[i]);
    front.forEach(p => { p.best = true; });
    if (front.length) {
      let d = `M${x(front[0].t).toFixed(1)} ${top}`;
      front.forEach((p, i) => {
        d += `L${x(p.t).toFixed(1)} ${(i ? y(front[i - 1].e) : top).toFixed(1)}L${x(p.t).toFixed(1)} ${y(p.e).toFixed(1)}`;
      });
      d += `L${W - right} ${y(front[front.length - 1].e).toFixed(1)}`;
      svg.append(draw('path', { class: 'front', d }));
    }
  }
  for (const p of points) {
    const q1 = p.row.ms_q1[state.time], q3 = p.row.ms_q3[state.time];
    if (finite(q1) && q1 > 0 && q3 > q1)
      svg.append(draw('line', { class: 'whisker', 'data-series': p.row.series, style: 'stroke:' + colour(p.row),
        x1: Math.max(left, x(q1)), x2: Math.min(W - right, x(q3)), y1: y(p.e), y2: y(p.e) }));
  }
  for (const p of points) {
    const shape = shapes[R.machines.findIndex(m => m.id === p.row.machine) % shapes.length] || 'circle';
    const dot = marker(shape, x(p.t), y(p.e), p.best ? 6 : 5);
    fill(dot, { class: 'point' + (p.best ? ' best' : ''), tabindex: 0, 'data-series': p.row.series, 'data-row': p.row.index,
      style: hollow(p.row) ? `fill:var(--card);stroke:${colour(p.row)}` : 'fill:' + colour(p.row),
      onmousemove: e => showTip(p.row, e), onmouseleave: hideTip,
      onfocus: () => { const b = dot.getBoundingClientRect(); showTip(p.row, { clientX: b.x, clientY: b.y }); }, onblur: hideTip,
      onclick: () => { location.hash = 'row' + p.row.index; } },
      [draw('title', {}, p.row.variant)]);
    svg.append(dot);
  }
  placeTags(svg, points, x, y);
  return svg;
}

// Names beside points, where there is room: those on the front first.
function placeTags(svg, points, x, y) {
  const taken = points.map(p => [x(p.t) - 6, y(p.e) - 6, x(p.t) + 6, y(p.e) + 6]);
  const free = box => box[0] > left && box[2] < W - right && box[1] > top && box[3] < H - bottom
    && taken.every(o => box[0] > o[2] || box[2] < o[0] || box[1] > o[3] || box[3] < o[1]);
  const shown = state.labels ? points : points.filter(p => p.best);
  for (const p of [...shown].sort((a, b) => (b.best ? 1 : 0) - (a.best ? 1 : 0))) {
    const text = p.row.variant, width = 5.9 * text.length, px = x(p.t), py = y(p.e);
    for (const [dx, dy, anchor] of [[8, -8, 'start'], [8, 16, 'start'], [-8, 16, 'end'], [-8, -8, 'end'], [10, 4, 'start'], [-10, 4, 'end']]) {
      const u = anchor === 'start' ? px + dx : px + dx - width;
      const box = [u, py + dy - 10, u + width, py + dy + 3];
      if (!free(box)) continue;
      taken.push(box);
      svg.append(draw('text', { class: 'tag', x: px + dx, y: py + dy, 'text-anchor': anchor }, text));
      break;
    }
  }
}
function noiseOf(group) {
  const scene = R.scenes.find(s => s.name === group.rows[0].scene);
  if (!scene || !finite(scene.reference_noise)) return null;
  return state.error === 'rmse' ? scene.reference_noise : state.error === 'mse' ? scene.reference_noise ** 2 : null;
}
function groups() {
  const found = new Map();
  for (const row of rows) {
    if (row.failed || (state.scene && row.scene !== state.scene)) continue;
    const key = row.scene + '\n' + row.plot + '\n' + row.kind;
    if (!found.has(key)) found.set(key, { title: row.scene, plot: row.plot || (row.kind === 'rays' ? 'ray by ray' : ''), rows: [] });
    found.get(key).rows.push(row);
  }
  return [...found.values()];
}
const plotArea = make('div', { class: 'plots' });
function highlight(area, series) {
  area.querySelectorAll('[data-series]').forEach(e => e.classList.toggle('dim', series !== null && e.dataset.series !== series));
}
function drawPlots() {
  plotArea.replaceChildren(...groups().map(group => {
    const card = make('div', { class: 'card' }, make('h3', {}, group.title, make('span', {}, group.plot ? ' · ' + group.plot : '')), plot(group));
    const legend = make('div', { class: 'legend' });
    for (const name of new Set(group.rows.map(r => r.series))) {
      const row = group.rows.find(r => r.series === name);
      legend.append(make('span', { onmouseenter: () => highlight(card, name), onmouseleave: () => highlight(card, null) },
        make('i', { style: hollow(row) ? `border:2px solid ${colour(row)}` : 'background:' + colour(row) }), name));
    }
    legend.append(make('span', { class: 'soft' }, 'dashed: the Pareto front'));
    card.append(legend);
    return card;
  }));
}

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
          : r.picture ? make('div', { class: 'pair' }, figure(r.picture, caption), figure(r.heat_map, 'FLIP error')) : make('p', { class: 'soft' }, caption),
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
        ['timed', `${R.repeats} turns of ${R.timed_frames}, in turn with all others`],
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
  make('h2', {}, 'Error against time'), make('p', { class: 'soft' }, 'Both axes are logarithmic; down and to the left is better. Points are medians, bars reach from the first to the third quartile.'),
  plotArea, make('h2', {}, 'Table'), make('p', { class: 'soft' }, 'Click a heading to sort by it; what is marked at its left is on the Pareto front of its plot.'),
  make('div', { class: 'scroll' }, table), pictureArea, tip].filter(e => e !== ''));
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
