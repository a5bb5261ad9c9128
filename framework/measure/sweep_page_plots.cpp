#include "measure/sweep_page.h"

namespace kestrel::page {

// No text of the results is ever taken for HTML: elements are made one by one, with textContent.
const std::string_view plotScript = R"js((() => {
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
// Hollow: the second eight series; of a tuned sweep the defaults beside what was found.
const hollow = row => R.tuning ? row.axes.setting === 'default' : Math.floor(seriesNames.indexOf(row.series) / 8) % 2 === 1;

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
)js";

} // namespace kestrel::page
