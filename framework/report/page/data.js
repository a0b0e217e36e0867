/* The records in the page, small helpers, and what is computed from the cells that are shown. All text of the records goes through
 * textContent. */
const data = JSON.parse(document.getElementById('data').textContent);
/* Names, units, formats, headings and help of all fields, and the metrics of trees (framework/record/fields.h). */
const schema = JSON.parse(document.getElementById('schema-data').textContent);
const sets = JSON.parse(document.getElementById('chart-data').textContent);
const summaries = JSON.parse(document.getElementById('summary-data').textContent);
const against = JSON.parse(document.getElementById('against-data').textContent);
const papersOf = JSON.parse(document.getElementById('paper-data').textContent);
const pictures = JSON.parse(document.getElementById('picture-data').textContent);

/* ---- small helpers ---- */
const whole = value => figure(value, 0);

/* What is known of the median `name` of a build, a trace or a cell: its 95 % interval; of too few
 * rounds for one, their range; of a single round, nothing. */
function spreadOf(row, name) {
  for (const [low, high, isInterval] of [['lo', 'hi', true], ['least', 'most', false]]) {
    const ends = [row[`${name}_${low}`], row[`${name}_${high}`]];
    if (ends.every(isNumber)) return { low: ends[0], high: ends[1], isInterval };
  }
  return null;
}
const brackets = spread => spread ? ` [${figure(spread.low)}, ${figure(spread.high)}]` : '';

/* "41.2 Mrays/s, 95 %: 40.1 to 43.0", "41.2 Mrays/s, range: 40.1 to 43.0" */
function measured(value, unit, spread) {
  const text = `${figure(value)} ${unit}`, kind = spread && spread.isInterval ? '95 %' : 'range';
  return spread ? `${text}, ${kind}: ${figure(spread.low)} to ${figure(spread.high)}` : text;
}

/* 10, 1 k, 12.3 M: for counts of rays. */
function brief(value) {
  if (!isNumber(value)) return dash;
  for (const [size, letter] of [[1e12, 'T'], [1e9, 'G'], [1e6, 'M'], [1e3, 'k']])
    if (value >= size) return `${Number((value / size).toPrecision(3))} ${letter}`;
  return String(Number(value.toPrecision(3)));
}

const unique = list => [...new Set(list)];
const plural = (n, word) => `${n} ${word}${n === 1 ? '' : 's'}`;

/* ---- the records ---- */
const merged = Array.isArray(data.merged) && data.merged.length > 0;
const builds = data.builds;
const buildById = new Map(builds.map(build => [build.id, build]));
const runOf = row => row.run || 0;

/* Parts of a cell's key (framework/record/cell.h), in which '/' stands between the parts alone: its rays; what traces them. */
const raysPart = t => t.cell.split('/builder=')[0];
const tracePart = t => t.cell.split('/').filter(part => /^(kernel|intersector)=/.test(part)).join('/');
const raysKey = t => JSON.stringify([raysPart(t), t.rays_hash || '', runOf(t)]);

/* Rays that no workload made say so wherever they are named. */
const raysName = t => t.rays_source === 'as given' ? `${t.rays} (rays as given)` : t.rays;

/* Embree's own trees; other tracers are no yardstick. */
const isReference = builder => /^embree-native(:|$)/.test(builder);

/* Of each ray set the fastest row of the reference, and its size: brute force traces only the first of the rays. */
const referenceRate = new Map(), setSize = new Map();
for (const t of data.traces) {
  setSize.set(raysKey(t), Math.max(setSize.get(raysKey(t)) || 0, t.count));
  if (!isReference(t.builder) || t.status !== 'ok' || !isNumber(t.mrays_s)) continue;
  referenceRate.set(raysKey(t), Math.max(referenceRate.get(raysKey(t)) || 0, t.mrays_s));
}

const traces = data.traces.map(t => {
  const reference = referenceRate.get(raysKey(t));
  return Object.assign({}, t, {
    record: buildById.get(t.build) || {}, acc: t.accuracy || {}, all: setSize.get(raysKey(t)),
    wrong: Boolean(t.wrong && t.counts_for_exit), ratio: reference && isNumber(t.mrays_s) ? t.mrays_s / reference : null,
  });
});

/* Whose rows are the reference: where the run's device is no CPU, another device's. */
const embree = traces.some(t => t.traced_on) ? 'Embree on the CPU' : 'Embree';

const isOk = t => t.status === 'ok' && isNumber(t.mrays_s);
/* Of several runs, which one: their number, or old and new of two side by side. */
const runName = run => against ? ['old', 'new'][run] : `run ${run + 1}`;
const label = t => t.builder + (t.traced_on ? ` (${t.traced_on})` : '') + (merged ? ` (${runName(runOf(t))})` : '');

/* 732.4 wrong OVERFLOW: capital letters above the limit; unlike: other cells with `exact` answer otherwise. */
function wrongText(t) {
  if (!isNumber(t.acc.wrong_ppm)) return 'unchecked';
  const mark = t.wrong ? ' WRONG' : t.acc.wrong_ppm > 0 ? ' wrong' : '';
  return figure(t.acc.wrong_ppm) + mark + (t.unlike > 0 ? ' unlike' : '') + (t.acc.overflowed > 0 ? ' OVERFLOW' : '');
}

/* ---- metrics of trees: those that are always measured, then those on request that a build has ---- */
const metricOf = (build, metric) => (build.tree || {})[metric.name];
const metrics = [false, true].flatMap(onRequest => schema.metrics.filter(m => m.on_request === onRequest &&
  (!onRequest || builds.some(b => isNumber(metricOf(b, m))))));

/* What speed is drawn against: these, counted work, and simulations. */
const measures = [...schema.metrics, { name: 'work_per_ray', title: 'counted work', unit: 'per ray' },
  ...[...new Set(sets.flatMap(s => s.cells.flatMap(c => Object.keys(c.metrics))))].filter(name => name.startsWith('simt:'))
    .map(name => ({ name, title: `simulated speed, not validated (${name.slice(5)})`, unit: 'bound on Mrays/s' }))];

/* ---- the cells of the charts, computed with the results (framework/report/chart.h) ---- */
for (const set of sets) {
  for (const cell of set.cells) cell.t = traces[cell.trace];
  for (const cell of set.cells) {
    const peers = set.cells.filter(other => other.reference && runOf(other.t) === runOf(cell.t)).map(other => other.mrays_s);
    Object.assign(cell, { label: label(cell.t), none: cell.wrong_rays === 0, msPerRay: cell.ms / cell.count,
                          total: cell.fixed_ms === null ? null : cell.fixed_ms + cell.ms * cell.rays / cell.count,
                          ratio: peers.length ? cell.mrays_s / Math.max(...peers) : null });
  }
}

/* ---- what follows from the cells that are shown ---- */

/* Of the cells with the same `key` the one with the largest `gain`. */
function bestPer(cells, key, gain) {
  const best = new Map();
  for (const cell of cells) {
    const other = best.get(key(cell));
    if (!other || gain(cell) > gain(other)) best.set(key(cell), cell);
  }
  return [...best.values()];
}

/* The points that none beats, by rising cost: at most the cost and at least the gain, one of them better. */
function paretoFront(points) {
  const front = [];
  for (const p of points.slice().sort((a, b) => a.cost - b.cost || b.gain - a.gain))
    if (front.length === 0 || p.gain > front[front.length - 1].gain) front.push(p);
  return front;
}

/* The lower envelope of the lines fixed_ms + n * msPerRay for n >= 0: who wins from which n on. */
function winnersOf(cells) {
  const result = [];
  let n = 0, current = cells.reduce((a, b) =>
    !a || b.fixed_ms < a.fixed_ms || (b.fixed_ms === a.fixed_ms && b.msPerRay < a.msPerRay) ? b : a, null);
  while (current) {
    result.push({ from: n, cell: current });
    let next = null, at = Infinity;
    for (const c of cells) {
      if (c.msPerRay >= current.msPerRay) continue;
      const cross = Math.max(n, (c.fixed_ms - current.fixed_ms) / (current.msPerRay - c.msPerRay));
      if (cross < at || (cross === at && next && c.msPerRay < next.msPerRay)) { at = cross; next = c; }
    }
    current = next;
    n = at;
  }
  return result;
}
