/* Draws the report from the records in #data: charts by Chart.js, tables by hand. All text of theirs goes through textContent. */
(() => {
'use strict';

const data = JSON.parse(document.getElementById('data').textContent);
const pictures = JSON.parse(document.getElementById('picture-data').textContent);
const $ = id => document.getElementById(id);

/* ---- small helpers ---- */
function el(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {}))
    if ((value ?? false) !== false) node.setAttribute(name, value === true ? '' : value);
  node.append(...children.filter(child => (child ?? null) !== null));
  return node;
}

const isNumber = Number.isFinite;
const dash = '\u2013';

/* About three digits, thousands grouped; a dash where nothing was measured. */
function figure(value) {
  if (!isNumber(value)) return dash;
  const size = Math.abs(value);
  if (size === 0) return '0';
  if (size < 1e-4 || size >= 1e9) return value.toExponential(2);
  const decimals = size >= 1000 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : size >= 0.01 ? 3 : 5;
  return value.toLocaleString('en', { minimumFractionDigits: Math.min(decimals, 2), maximumFractionDigits: decimals });
}
const whole = value => isNumber(value) ? Math.round(value).toLocaleString('en') : dash;
const interval = (value, low, high) =>
  [value, low, high].every(isNumber) ? `${figure(value)} [${figure(low)}, ${figure(high)}]` : figure(value);

function bytes(value) {
  if (!isNumber(value)) return dash;
  const unit = value < 1024 ? 0 : Math.min(4, Math.floor(Math.log2(value) / 10)), scaled = value / 1024 ** unit;
  return `${scaled.toFixed(unit > 0 && scaled < 10 ? 1 : 0)} ${['B', 'KiB', 'MiB', 'GiB', 'TiB'][unit]}`;
}

/* 10, 1k, 1M: for counts of rays and images. */
function brief(value) {
  if (!isNumber(value)) return dash;
  for (const [size, letter] of [[1e9, 'G'], [1e6, 'M'], [1e3, 'k']])
    if (value >= size) return `${Number((value / size).toPrecision(3))}${letter}`;
  return String(Number(value.toPrecision(3)));
}

const unique = list => [...new Set(list)];

/* ---- the records ---- */
const merged = Array.isArray(data.merged) && data.merged.length > 0;
const builds = data.builds;
const buildById = new Map(builds.map(build => [build.id, build]));
const runOf = row => row.run || 0;
const raysKey = t => JSON.stringify([t.scene, t.view || '', t.rays, t.rays_hash || '', runOf(t)]);

/* Of each ray set the fastest reference row, and its size: brute force traces only the first of the rays. */
const referenceRate = new Map(), setSize = new Map();
for (const t of data.traces) {
  setSize.set(raysKey(t), Math.max(setSize.get(raysKey(t)) || 0, t.count));
  if (!t.reference || t.status !== 'ok' || !isNumber(t.mrays_s)) continue;
  referenceRate.set(raysKey(t), Math.max(referenceRate.get(raysKey(t)) || 0, t.mrays_s));
}

const traces = data.traces.map(t => {
  const build = buildById.get(t.build) || {};
  const layouts = build.layouts_ms || {}, sahs = build.layouts_sah || {}, tree = build.tree || {};
  const reference = referenceRate.get(raysKey(t));
  return Object.assign({}, t, {
    record: build, acc: t.accuracy || {}, all: setSize.get(raysKey(t)), wrong: Boolean(t.wrong && t.counts_for_exit),
    ratio: reference && isNumber(t.mrays_s) ? t.mrays_s / reference : null,
    layoutMs: t.reference ? 0 : isNumber(layouts[t.layout]) ? layouts[t.layout] : null,
    sah: t.reference ? null : isNumber(sahs[t.layout]) ? sahs[t.layout] : tree.sah,
  });
});

const isOk = t => t.status === 'ok' && isNumber(t.mrays_s);
/* Fit to be recommended: right to within the run's limit, or a reference. */
const usable = t => t.reference || (!t.wrong && (t.counts_for_exit || t.acc.wrong_ppm === 0));
const label = t => merged ? `${t.builder} (run ${runOf(t) + 1})` : t.builder;

/* Where the cell stands on the axis of wrong rays: the upper 95 % bound of a Poisson rate of which k of n were seen, by Byar's
 * approximation; 3/n for k = 0. At the counted rate, a cell with one wrong ray would stand left of one with none. */
function wrongAt(t) {
  if (!isNumber(t.acc.wrong_ppm) || !(t.acc.checked > 0)) return null;
  const next = t.acc.wrong_ppm * t.acc.checked / 1e6 + 1;
  return { ppm: next * (1 - 1 / (9 * next) + 1.6449 / (3 * Math.sqrt(next))) ** 3 * 1e6 / t.acc.checked, none: next === 1 };
}

function wrongText(t) {
  if (!isNumber(t.acc.wrong_ppm)) return 'unchecked';
  const mark = t.wrong ? ' WRONG' : t.acc.wrong_ppm > 0 ? ' wrong' : '';
  return figure(t.acc.wrong_ppm) + mark + (t.acc.overflowed > 0 ? ' OVERFLOW' : '');
}

/* ---- page head ---- */
function contextList(list, entries) {
  for (const [name, value] of entries)
    if ((value ?? '') !== '') list.append(el('div', {}, el('dt', {}, name), el('dd', {}, String(value))));
}

function head() {
  const c = data.context;
  const done = traces.filter(isOk).length, bad = traces.filter(t => t.wrong).length;
  const inexact = traces.filter(t => !t.wrong && t.acc.wrong_ppm > 0).length;
  const missing = traces.concat(builds).filter(row => row.status !== 'ok').length, skipped = data.skipped.length;
  const plural = (n, word) => `${n} ${word}${n === 1 ? '' : 's'}`;
  $('summary').append(
    `${plural(data.scenes.length, 'scene')}, ${plural(builds.length, 'build')}, ${plural(done, 'cell')} traced; `,
    el('span', { class: bad ? 'bad' : null },
       bad ? `${plural(bad, 'cell')} WRONG above the limit` : 'no cell above the limit for wrong answers'),
    (inexact ? `; ${plural(inexact, 'other cell')} with wrong answers (references, inexact, or within the limit)` : '') +
    (missing ? `; ${plural(missing, 'row')} without a result` : '') + (skipped ? `; ${skipped} skipped` : '') + '.');
  contextList($('context'), [
    ['Date', c.date && c.date.replace('T', ' ').replace('Z', ' UTC')], ['Revision', c.revision], ['Host', c.host],
    ['Processor', c.cpu && c.cpu_threads ? `${c.cpu}, ${c.cpu_threads} threads` : c.cpu],
    ['Device', c.device], ['Driver', c.driver], ['OpenCL', c.opencl], ['Seed', c.seed]]);
  contextList($('more-context').querySelector('dl'), [
    ['Build flags', c.build_flags], ['Kernels', c.kernels], ['Compute units', c.compute_units],
    ['Load (1, 5, 15 min)', Array.isArray(c.load) ? c.load.map(figure).join(', ') : c.load],
    ['Command', c.command]]);
  (data.merged || []).forEach((m, i) => contextList($('more-context').querySelector('dl'), [
    [`Run ${i + 2}`, [m.date, m.revision, m.host, m.device].filter(Boolean).join(', ')],
    [`Command of run ${i + 2}`, m.command]]));
  $('version').textContent = [c.version, c.revision].filter(Boolean).join(', revision ');
  document.title = `bvhbench report, ${data.scenes.map(s => s.name).join(', ')}`;
}

/* ---- colours and marks ---- */
const palettes = {
  light: ['#0b62b0', '#b8420f', '#17734a', '#8a3a9b', '#7a5a00', '#00727a', '#b0103e', '#5a5f66', '#4b6b00', '#4f46c4',
          '#9c4668', '#2b2b2b'],
  dark: ['#6cb4f5', '#f59563', '#5fce98', '#d293e3', '#d9b84a', '#54cdd4', '#f57f9d', '#b5b8bd', '#a9cc5a', '#a5a0ff',
         '#e3a3bd', '#f2f2f2'],
};
const dark = window.matchMedia('(prefers-color-scheme: dark)');
let printing = false;
const scheme = () => dark.matches && !printing ? 'dark' : 'light';
const styleOf = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
function theme() {
  if (printing) return { page: '#ffffff', text: '#000000', muted: '#40464e', line: '#b8bdc4' };
  return { page: styleOf('--panel'), text: styleOf('--text'), muted: styleOf('--muted'), line: styleOf('--line') };
}

const builderNames = unique(builds.map(label).concat(traces.map(label)));
const colourOf = name => palettes[scheme()][builderNames.indexOf(name) % palettes.light.length];
const hidden = new Set();

const kernelNames = unique(traces.filter(t => !t.reference).map(t => t.kernel));
const shapes = Object.entries({ circle: '\u25cf', triangle: '\u25b2', rect: '\u25a0', rectRot: '\u25c6', star: '\u2217', cross: '+' });
const shapeOf = t => t.reference ? 'crossRot' : shapes[kernelNames.indexOf(t.kernel) % shapes.length][0];

/* ---- what is picked ---- */
const picked = { scene: '', rays: '', view: '' };
function options(select, values, names, key) {
  if (!values.includes(picked[key])) picked[key] = values[0] || '';
  select.replaceChildren(...values.map((v, i) => el('option', { value: v }, names[i])));
  select.value = picked[key];
  select.disabled = values.length < 2;
}

function pick() {
  const scenes = unique(traces.map(t => t.scene));
  options($('pick-scene'), scenes, scenes, 'scene');
  const inScene = traces.filter(t => t.scene === picked.scene);
  const rays = unique(inScene.map(t => t.rays));
  options($('pick-rays'), rays, rays, 'rays');
  const views = unique(inScene.filter(t => t.rays === picked.rays).map(t => t.view || ''));
  if (views.length > 1) views.push('*');
  options($('pick-view'), views, views.map(v => v === '*' ? 'all' : v || 'whole scene'), 'view');
}

const shown = t => t.scene === picked.scene && t.rays === picked.rays &&
  (picked.view === '*' || (t.view || '') === picked.view) && isOk(t) && !hidden.has(label(t));

/* ---- charts ---- */
const charts = {};
const partly = t => t.count < t.all ? ` (traced: the first ${whole(t.count)} of ${whole(t.all)})` : '';
function tooltipLines(t) {
  const a = t.acc;
  const lines = [`${t.scene}, ${t.rays}${t.view ? `, view ${t.view}` : ''}`,
    `${t.kernel}${t.layout ? ` on ${t.layout}` : ''}${t.intersector ? `, ${t.intersector}` : ''}`,
    `${interval(t.mrays_s, t.mrays_s_lo, t.mrays_s_hi)} Mrays/s` + (t.ratio ? `, ${figure(t.ratio)} of Embree` : ''),
    `wrong ppm ${wrongText(t)}` + (isNumber(a.checked) ? ` of ${whole(a.checked)} rays` : '') + partly(t)];
  if (a.wrong_ppm > 0) lines.push(`missed ${whole(a.missed)}, false ${whole(a.false)}, wrong t ${whole(a.wrong_t)}`);
  if (isNumber(t.node_tests_per_ray))
    lines.push(`${figure(t.node_tests_per_ray)} box and ${figure(t.prim_tests_per_ray)} primitive tests per ray`);
  const b = t.record;
  if (isNumber(b.build_ms_median))
    lines.push(`built in ${figure(b.build_ms_median)} ms (${figure(b.mprims_s)} Mprims/s)` +
               (isNumber(t.sah) ? `, SAH ${figure(t.sah)}` : ''));
  return lines;
}

/* The label of a tick on a logarithmic axis: only powers of ten have one. */
function powersOfTen(value) {
  if (!(Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-9)) return '';
  return value < 0.001 ? value.toExponential(0) : brief(value);
}

function axis(title, log, extra) {
  const t = theme();
  const grid = context => !log || (context.tick && powersOfTen(context.tick.value)) ? t.line : 'transparent';
  return Object.assign({
    type: log ? 'logarithmic' : 'linear',
    title: { display: true, text: title, color: t.text },
    grid: { color: grid, borderColor: t.muted },
    ticks: Object.assign({ color: t.muted, maxRotation: 0 }, log ? { callback: powersOfTen, autoSkip: false } : {}),
  }, extra);
}

/* Whole decades around the values, so that a logarithmic axis has at least two labels. */
function decades(values) {
  const logs = values.filter(v => v > 0).map(Math.log10);
  if (logs.length === 0) return {};
  return { min: 10 ** Math.floor(Math.min(...logs) - 1e-9), max: 10 ** Math.ceil(Math.max(...logs) + 1e-9) };
}

/* `lines(raw)` gives the text that is shown where the pointer is. */
function draw(id, name, datasets, scales, lines) {
  const t = theme();
  if (charts[id]) charts[id].destroy();
  const marks = datasets.reduce((sum, set) => sum + (set.isLine ? 0 : set.data.length), 0);
  $(id).setAttribute('aria-label', `${name}: ${marks} marks. The tables below hold the same figures.`);
  charts[id] = new Chart($(id), {
    type: 'scatter',
    data: { datasets },
    options: {
      animation: false, responsive: true, maintainAspectRatio: false,
      interaction: { mode: 'nearest', intersect: true },
      scales,
      plugins: {
        legend: { display: false },
        tooltip: {
          backgroundColor: t.page, borderColor: t.muted, borderWidth: 1, titleColor: t.text, bodyColor: t.text,
          displayColors: false, padding: 8, filter: item => !item.dataset.isLine || item.dataset.hasTip,
          callbacks: { title: items => items.length ? items[0].dataset.label : '', label: item => lines(item.raw) },
        } } } });
}

/* One dataset per builder. `place(t)` gives {x, y, none} or null. */
function marksOf(rows, place) {
  return unique(rows.map(label)).map(name => {
    const points = rows.filter(t => label(t) === name)
      .map(t => Object.assign({ row: t }, place(t))).filter(p => isNumber(p.x) && isNumber(p.y));
    const colour = colourOf(name);
    return { label: name, data: points, pointBorderColor: colour, pointRadius: 6, pointHoverRadius: 8, pointBorderWidth: 2, clip: 10,
             pointBackgroundColor: points.map(p => p.none ? theme().page : colour),
             pointStyle: points.map(p => shapeOf(p.row)) };
  }).filter(set => set.data.length > 0);
}

function line(name, points, style) {
  return Object.assign({ label: name, data: points, isLine: true, showLine: true, pointRadius: 0, pointHitRadius: 0,
                         borderColor: theme().muted, borderWidth: 1.5, order: 10, clip: false }, style);
}

/* Cells that none beats in speed and accuracy; as steps, from right to left of falling speed. */
function paretoFront(points) {
  const front = [];
  for (const p of points.slice().sort((a, b) => a.x - b.x || b.y - a.y))
    if (front.length === 0 || p.y > front[front.length - 1].y) front.push({ x: p.x, y: p.y });
  return front;
}

function drawAccuracy(rows) {
  const sets = marksOf(rows, t => {
    const at = wrongAt(t);
    return at ? { x: at.ppm, y: t.mrays_s, none: at.none } : {};
  });
  const points = sets.flatMap(set => set.data);
  const range = decades(points.map(p => p.x)), front = paretoFront(points.filter(p => !p.row.reference));
  if (front.length > 0) {
    front.unshift({ x: front[0].x, y: 0 });
    front.push({ x: range.max, y: front[front.length - 1].y });
    sets.push(line('Pareto front', front, { stepped: 'before' }));
  }
  const unchecked = rows.length - points.length;
  const clean = points.filter(p => p.none).map(p => p.row.acc.checked);
  $('accuracy-note').textContent = (clean.length ? `Here n is ${unique(clean).map(whole).slice(0, 4).join(' or ')}. ` : '') +
    (unchecked ? `${unchecked} cells were not checked and are not drawn.` : '') +
    (points.length ? '' : 'No cell of this choice was traced and checked.');
  draw('chart-accuracy', 'Trace speed against wrong rays per million', sets,
       { x: axis('wrong rays per million, upper 95 % bound (log scale; hollow: none found)', true, range),
         y: axis('Mrays/s', false, { beginAtZero: true, grace: '5%' }) }, p => p.row ? tooltipLines(p.row) : '');
}

/* Per builder the fastest kernel that is within the limit, averaged over the views that are shown; as for the whole set where
 * only its first rays were traced. */
function timeCurves(rows) {
  const cells = new Map();
  for (const t of rows) {
    const build = t.record;
    if (!usable(t) || ![build.build_ms_median, t.layoutMs, t.ms_median].every(isNumber) || !(t.count > 0)) continue;
    const key = JSON.stringify([t.build, t.kernel, t.layout, t.intersector]), fixed = build.build_ms_median + t.layoutMs;
    const cell = cells.get(key) || { row: t, ms: 0, rays: 0, views: 0, ppm: 0, fixed };
    cell.ms += t.ms_median * t.all / t.count; cell.rays += t.all; cell.views++;
    cell.ppm = Math.max(cell.ppm, isNumber(t.acc.wrong_ppm) ? t.acc.wrong_ppm : 0);
    cells.set(key, cell);
  }
  const best = new Map();
  for (const cell of cells.values()) {
    cell.ms /= cell.views; cell.rays /= cell.views;
    const other = best.get(label(cell.row));
    if (!other || cell.ms < other.ms) best.set(label(cell.row), cell);
  }
  return [...best.entries()].map(([name, cell]) => Object.assign({ name }, cell));
}

/* The lower envelope of the lines fixed + n * ms for n >= 0: who wins from which n on. */
function envelope(curves) {
  const result = [];
  let n = 0, current = curves.reduce((a, b) =>
    !a || b.fixed < a.fixed || (b.fixed === a.fixed && b.ms < a.ms) ? b : a, null);
  while (current) {
    result.push({ from: n, curve: current });
    let next = null, at = Infinity;
    for (const c of curves) {
      if (c.ms >= current.ms) continue;
      const cross = Math.max(n, (c.fixed - current.fixed) / (current.ms - c.ms));
      if (cross < at || (cross === at && next && c.ms < next.ms)) { at = cross; next = c; }
    }
    current = next;
    n = at;
  }
  return result;
}

function drawTime(rows) {
  const curves = timeCurves(rows);
  const ours = envelope(curves.filter(c => !c.row.reference)), last = ours.length ? ours[ours.length - 1].from : 0;
  const low = -1, high = Math.max(4, Math.min(9, Math.ceil(Math.log10(Math.max(last, 1)) + 1)));
  const sets = curves.map(c => {
    const points = Array.from({ length: 81 }, (_, i) => 10 ** (low + (high - low) * i / 80))
      .map(n => ({ x: n, y: c.fixed + n * c.ms, curve: c }));
    return line(c.name, points, { borderColor: colourOf(c.name), borderWidth: 2, hasTip: true, pointHitRadius: 6,
                                  borderDash: c.row.reference ? [6, 4] : [], clip: 0 });
  });
  $('time-note').textContent = curves.length ? `n = 1 traces ${whole(curves[0].rays)} rays. Dashed: Embree with its own trees.`
                                             : 'No build and trace of this choice can be combined.';
  $('winners').replaceChildren(...ours.map((w, i) => {
    const to = i + 1 < ours.length ? ours[i + 1].from : Infinity;
    const range = ours.length === 1 ? 'for every n' : i === 0 ? `up to n = ${brief(to)}` :
      to === Infinity ? `from n = ${brief(w.from)} on` : `n = ${brief(w.from)} to ${brief(to)}`;
    return el('li', {}, `${range}: ${w.curve.name} with ${w.curve.row.kernel}` +
      ` (${figure(w.curve.fixed)} ms before the first ray, ${figure(w.curve.ms)} ms per image,` +
      ` wrong ppm ${figure(w.curve.ppm)}${partly(w.curve.row)})`);
  }));
  draw('chart-time', 'Time to image per builder', sets,
       { x: axis('n, how often the rays are traced (log scale)', true, { min: 10 ** low, max: 10 ** high }),
         y: axis('ms (log scale)', true, {}) },
       p => [`n = ${brief(p.x)}: ${figure(p.y)} ms`, `${figure(p.curve.fixed)} ms build and layout, ${figure(p.curve.ms)} ms per image`,
             `kernel ${p.curve.row.kernel}, wrong ppm ${figure(p.curve.ppm)}${partly(p.curve.row)}`]);
}

/* Each builder once: its fastest usable cell among those shown. */
function bestPerBuilder(rows) {
  const best = new Map();
  for (const t of rows.filter(usable))
    if (!best.has(label(t)) || best.get(label(t)).mrays_s < t.mrays_s) best.set(label(t), t);
  return [...best.values()];
}

function drawBuild(rows) {
  const bySah = $('pick-quality').value === 'sah';
  const sets = marksOf(bestPerBuilder(rows), t => ({
    x: t.record.mprims_s, y: bySah ? (t.record.tree || {}).sah : t.mrays_s, none: !(t.acc.wrong_ppm > 0) }));
  $('build-note').textContent = bySah
    ? 'Right and down is better. Embree\u2019s own trees are not seen, so they have no SAH.'
    : 'Right and up is better. The fastest kernel of each whose answers are within the limit.';
  draw('chart-build', 'Build speed against quality', sets,
       { x: axis('Mprims/s built (log scale)', true, decades(sets.flatMap(s => s.data).map(p => p.x))),
         y: axis(bySah ? 'SAH' : 'Mrays/s', false, { beginAtZero: true, grace: '5%' }) }, p => tooltipLines(p.row));
}

function drawSah(rows) {
  const sets = marksOf(rows, t => ({ x: t.sah, y: t.mrays_s, none: !(t.acc.wrong_ppm > 0) }));
  const xs = sets.flatMap(set => set.data).map(p => p.x);
  const rate = Math.max(0, ...rows.filter(t => t.reference).map(t => t.mrays_s));
  if (rate > 0 && xs.length > 0)
    sets.push(line('fastest embree-native', [{ x: Math.min(...xs), y: rate }, { x: Math.max(...xs), y: rate }],
                   { borderDash: [6, 4] }));
  $('sah-note').textContent = 'Filled marks gave wrong answers.' +
    (rate > 0 ? ' Dashed: the fastest embree-native row, whose tree is not seen.' : '');
  draw('chart-sah', 'Trace speed against SAH', sets,
       { x: axis('SAH', false, { grace: '5%' }), y: axis('Mrays/s', false, { beginAtZero: true, grace: '5%' }) },
       p => p.row ? tooltipLines(p.row) : '');
}

function drawAll() {
  const rows = traces.filter(shown);
  for (const chart of [drawAccuracy, drawTime, drawBuild, drawSah]) chart(rows);
}

function drawLegend() {
  const names = unique(traces.filter(t => t.scene === picked.scene && t.rays === picked.rays).map(label));
  $('legend').replaceChildren(...names.map(name => {
    const chip = el('i', { 'aria-hidden': 'true' });
    chip.style.background = colourOf(name);
    const button = el('button', { type: 'button', 'aria-pressed': !hidden.has(name) + '' }, chip, name);
    button.addEventListener('click', () => {
      if (!hidden.delete(name)) hidden.add(name);
      button.setAttribute('aria-pressed', !hidden.has(name) + '');
      drawAll();
    });
    return button;
  }));
  $('shapes').textContent = 'Marks: ' + kernelNames.map((k, i) => `${shapes[i % shapes.length][1]} ${k}`)
    .concat(traces.some(t => t.reference) ? ['\u2715 Embree with its own trees (reference)'] : []).join('   ') + '.';
}

function redraw() { pick(); drawLegend(); drawAll(); }

/* ---- tables ---- */
const classOf = (c, row) => [c.number && 'number', c.wide && 'wide', c.minor && 'minor', row && c.css && c.css(row)]
  .filter(Boolean).join(' ') || null;

/* A column: name, value(row) for sorting, text(row) for showing; number: right-aligned; minor: not on paper; css(row): a class. */
function addTable(section, caption, columns, rows, settings) {
  const body = el('tbody');
  const headers = columns.map((column, i) => {
    const button = el('button', { type: 'button', title: column.title }, column.name);
    button.addEventListener('click', () => sortBy(i));
    return el('th', { scope: 'col', class: classOf(column), 'aria-sort': 'none' }, button);
  });
  const state = { column: -1, down: false, words: [], odd: false };
  const status = el('span', { class: 'note', role: 'status' });

  const cells = rows.map(row => columns.map(c => c.text ? c.text(row) : row[c.key] ?? dash));
  const nodes = rows.map((row, r) => el('tr', { class: settings.css ? settings.css(row) : null },
    ...columns.map((c, i) => el(i === 0 ? 'th' : 'td', { scope: i === 0 ? 'row' : null, class: classOf(c, row) },
                                String(cells[r][i])))));
  const search = rows.map((row, r) => cells[r].join(' ').toLowerCase());

  function value(r) {
    const c = columns[state.column];
    const v = c.value ? c.value(rows[r]) : cells[r][state.column];
    return typeof v === 'number' ? (Number.isFinite(v) ? v : null) : v === dash || v === '' ? null : v;
  }
  /* Rows without a value stay last in both directions. */
  function compare(a, b) {
    const x = value(a) ?? null, y = value(b) ?? null;
    if (x === null || y === null) return (x === null) - (y === null) || a - b;
    const order = typeof x === 'number' && typeof y === 'number' ? x - y : String(x).localeCompare(String(y), 'en');
    return (state.down ? -order : order) || a - b;
  }
  function show() {
    const list = [...rows.keys()].filter(r => (!state.odd || settings.odd(rows[r])) &&
                                              state.words.every(word => search[r].includes(word)));
    if (state.column >= 0) list.sort(compare);
    body.replaceChildren(...list.map(r => nodes[r]));
    status.textContent = `${list.length} of ${rows.length} rows`;
  }
  function sortBy(i) {
    state.down = state.column === i ? !state.down : Boolean(columns[i].number);
    state.column = i;
    headers.forEach((th, k) => th.setAttribute('aria-sort', k !== i ? 'none' : state.down ? 'descending' : 'ascending'));
    show();
  }

  if (settings.tools) {
    const filter = el('input', { type: 'search', placeholder: 'words of a row' });
    const odd = el('input', { type: 'checkbox' });
    const change = () => {
      Object.assign(state, { words: filter.value.toLowerCase().split(/\s+/).filter(Boolean), odd: odd.checked });
      show();
    };
    for (const input of [filter, odd]) input.addEventListener('input', change);
    section.append(el('div', { class: 'controls tools' }, el('label', {}, 'Filter ', filter),
                      el('label', {}, odd, ' only wrong answers and rows without a result'), status));
  }
  show();
  section.append(el('div', { class: 'scroll' + (settings.narrow ? ' narrow' : ''), role: 'region', tabindex: '0',
                             'aria-label': caption },
    el('table', {}, el('caption', {}, caption), el('thead', {}, el('tr', {}, ...headers)), body,
       settings.foot ? el('tfoot', {}, settings.foot) : null)));
}

const runColumn = merged ? [{ name: 'Run', number: true, value: runOf, text: row => runOf(row) + 1 }] : [];
const num = (name, get, title, text) =>
  ({ name, number: true, value: get, text: row => (text || figure)(get(row)), title });
const minor = columns => columns.map(column => Object.assign(column, { minor: true }));
const statusText = row => row.status === 'ok' ? 'ok' : row.reason ? `${row.status}: ${row.reason}` : row.status;

function traceTable() {
  const acc = (name, key, title) => num(name, t => t.acc[key], title, whole);
  addTable($('traces'), 'Traces. Press a heading to sort; the table scrolls sideways.', [
    { name: 'Builder', text: t => t.builder }, ...runColumn,
    { name: 'Scene', text: t => t.scene }, { name: 'Rays', text: t => t.rays },
    { name: 'View', text: t => t.view || dash }, { name: 'Kernel', text: t => t.kernel },
    { name: 'Intersector', text: t => t.intersector || dash },
    { name: 'Mrays/s [95 %]', number: true, value: t => t.mrays_s,
      text: t => t.status === 'ok' ? interval(t.mrays_s, t.mrays_s_lo, t.mrays_s_hi) : t.status },
    { name: 'Wrong ppm', number: true, value: t => t.acc.wrong_ppm, text: t => t.status === 'ok' ? wrongText(t) : dash,
      css: t => t.wrong || t.acc.overflowed > 0 ? 'wrong' : t.acc.wrong_ppm > 0 ? 'odd' : '' },
    num('/Embree', t => t.ratio, 'ratio to the fastest embree-native row on the same rays'),
    acc('Missed', 'missed'), acc('False', 'false'), acc('Wrong t', 'wrong_t'),
    num('Box tests', t => t.node_tests_per_ray, 'per ray'), num('Prim. tests', t => t.prim_tests_per_ray, 'per ray'),
    ...minor([num('Rays traced', t => t.count, undefined, whole), num('of', t => t.all, 'rays in the set', whole),
    num('Counted', t => t.counted, 'rays whose tests were counted', whole),
    acc('Overflowed', 'overflowed', 'of the counted rays'),
    { name: 'Query', text: t => t.query || dash }, { name: 'Layout', text: t => t.layout ? t.layout + (t.native ? ', native' : '') : dash },
    num('ms', t => t.ms_median, 'median wall clock'), num('Event ms', t => t.event_ms, 'OpenCL profiling'),
    num('CPU ms', t => t.cpu_ms, 'process time of all threads'),
    acc('Ties', 'ties'), acc('Margin limited', 'margin_limited'), acc('Oracle wrong', 'oracle_wrong'),
    num('t error p99', t => t.acc.t_ulp_p99, 'units of the last place'),
    num('t error max', t => t.acc.t_ulp_max, 'units of the last place')]),
    { name: 'Status', text: statusText, wide: true, css: t => t.status === 'ok' ? '' : 'odd' },
  ], traces, { tools: true, css: t => t.reference ? 'reference' : null,
               odd: t => t.status !== 'ok' || t.acc.wrong_ppm > 0 || t.acc.overflowed > 0 });
  if (data.skipped.length > 0)
    addTable($('traces'), 'Skipped: what was asked for and not traced, and why', [
      { name: 'Scene', text: s => s.scene }, ...runColumn, { name: 'Rays', text: s => s.rays },
      { name: 'View', text: s => s.view || dash }, { name: 'Reason', text: s => s.reason || dash, wide: true },
    ], data.skipped, {});
}

function pairs(object) {
  const list = Object.entries(object || {}).filter(([, v]) => v !== null);
  return list.length ? list.map(([k, v]) => `${k} ${typeof v === 'number' ? figure(v) : String(v)}`).join(', ') : dash;
}

function buildTable() {
  const tree = (name, key, text) => num(name, b => (b.tree || {})[key], undefined, text);
  addTable($('builds'), 'Builds. Press a heading to sort; the table scrolls sideways.', [
    { name: 'Builder', text: b => b.builder }, ...runColumn, { name: 'Scene', text: b => b.scene },
    num('Mprims/s', b => b.mprims_s),
    { name: 'Build ms [95 %]', number: true, value: b => b.build_ms_median,
      text: b => b.status === 'ok' ? interval(b.build_ms_median, b.build_ms_lo, b.build_ms_hi) : b.status },
    ...minor([num('Cold ms', b => b.cold_ms, 'first build after allocation'),
              num('Transfer ms', b => b.transfer_ms, 'between host and device')]),
    tree('SAH', 'sah'), tree('EPO', 'epo'), tree('Depth', 'depth', whole),
    ...minor([tree('Arity', 'arity', whole), tree('Nodes', 'nodes', whole), tree('References', 'refs', whole)]),
    num('Tree', b => isNumber(b.bytes_native) ? b.bytes_native : (b.tree || {}).bytes_tree, undefined, bytes),
    tree('Peak', 'bytes_peak', bytes),
    { name: 'Layouts ms', text: b => pairs(b.layouts_ms), wide: true },
    ...minor([['Phases ms', 'phases_ms'], ['Layouts SAH', 'layouts_sah'], ['Parameters', 'params']].map(
      ([name, key]) => ({ name, text: b => pairs(b[key]), wide: true }))),
    { name: 'Status', text: statusText, wide: true, css: b => b.status === 'ok' ? '' : 'odd' },
  ], builds, { tools: true, css: b => b.reference ? 'reference' : null, odd: b => b.status !== 'ok' });
}

function sceneTable() {
  const profile = (name, key, title, text) => num(name, s => (s.profile || {})[key], title, text);
  const size = s => {
    const { lo, hi } = s.bounds || {};
    return Array.isArray(lo) && Array.isArray(hi) ? lo.map((v, i) => figure(hi[i] - v)).join(' \u00d7 ') : dash;
  };
  addTable($('scenes'), 'Scenes and their profiles', [
    { name: 'Scene', text: s => s.name }, { name: 'Kind', text: s => s.kind || dash },
    num('Primitives', s => s.prims, undefined, whole), { name: 'Extent', text: size },
    profile('Flatness', 'flatness', 'shortest by longest side'),
    profile('Smallest', 'size_min', 'box diagonal'), profile('Median', 'size_median', 'box diagonal'),
    profile('Largest', 'size_max', 'box diagonal'), profile('Overlap', 'overlap', 'other boxes that hold a centroid, mean'),
    profile('Zero area', 'zero_area', undefined, whole), profile('Equal centroids', 'duplicate_centroids', undefined, whole),
    profile('Code bits', 'code_bits', 'that separate the centroids', whole),
    { name: 'Closed', text: s => ({ true: 'yes', false: 'no' })[(s.profile || {}).closed] || dash },
    ...minor([{ name: 'Views', text: s => (s.views || []).join(', ') || dash, wide: true },
              { name: 'Hash', text: s => s.hash || dash }]),
  ], data.scenes, {});
}

/* Files of earlier versions have the steps only, whose total is then their sum. */
function stepTable() {
  const times = data.time_ms || {}, rows = [];
  const add = (name, ms) => { if (isNumber(ms)) rows.push({ name, ms }); };
  add('Builds, timed', times.build);
  add('Traces, timed', times.trace);
  for (const [name, ms] of Object.entries(data.steps_ms || {})) add(name, ms);
  add('Not accounted for', times.other);
  const total = times.total ?? rows.reduce((sum, row) => sum + row.ms, 0);
  const seconds = ms => (ms / 1000).toFixed(3);
  addTable($('steps'), `Seconds per step${isNumber(times.total) ? '' : '; those of builds and traces are not recorded'}`, [
    { name: 'Step', text: s => s.name },
    { name: 'Seconds', number: true, value: s => s.ms, text: s => seconds(s.ms) },
    { name: 'Share', number: true, value: s => s.ms, text: s => total > 0 ? `${(100 * s.ms / total).toFixed(1)} %` : dash },
  ], rows, { narrow: true, foot: el('tr', { class: 'total' }, el('th', { scope: 'row' }, 'Total'),
                                    el('td', { class: 'number' }, seconds(total)), el('td', {})) });
}

function pictureGrid() {
  if (pictures.length === 0) $('pictures').append(el('p', { class: 'note' }, 'The run made no pictures.'));
  $('pictures').append(el('div', { class: 'pictures' }, ...pictures.map(p => {
    const text = [p.scene, p.view, p.caption].filter(Boolean).join(', ');
    const picture = p.src ? el('img', { src: p.src, alt: text }) : el('p', { class: 'notice' }, `${p.path}: ${p.missing}`);
    return el('figure', {}, picture, el('figcaption', {}, text));
  })));
}

for (const part of [head, traceTable, buildTable, sceneTable, stepTable, pictureGrid]) part();
Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
redraw();
for (const [id, key] of [['pick-scene', 'scene'], ['pick-rays', 'rays'], ['pick-view', 'view']])
  $(id).addEventListener('change', event => { picked[key] = event.target.value; redraw(); });
$('pick-quality').addEventListener('change', () => drawBuild(traces.filter(shown)));
dark.addEventListener('change', redraw);
window.addEventListener('beforeprint', () => { printing = true; redraw(); });
window.addEventListener('afterprint', () => { printing = false; redraw(); });
})();
