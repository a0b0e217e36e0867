/* The charts of the chosen set of cells. */
const partly = c => c.count < c.rays ? ` (traced: the first ${whole(c.count)} of ${whole(c.rays)})` : '';
const madeOf = c => c.reference ? `${c.t.kernel} with a tree of its own` :
  [c.t.kernel, c.t.layout && `on ${c.t.layout}`, c.t.intersector && `with ${c.t.intersector}`,
   c.t.native === true && '(native tree)'].filter(Boolean).join(' ');

/* "732.4 (12 of 16,384)", "at most 183 (0 of 16,384)" */
function rateText(c) {
  if (!isNumber(c.ppm)) return 'unchecked';
  return `${c.none ? 'at most ' : ''}${figure(c.ppm)} (${whole(c.wrong_rays)} of ${whole(c.checked)})`;
}

function cellLines(c) {
  const t = c.t, b = t.record;
  const lines = [`${t.scene}, ${raysName(t)}, ${c.views > 1 ? `${c.views} views together` : t.view ? `view ${t.view}` : 'whole scene'}`,
    madeOf(c), measured(c.mrays_s, 'Mrays/s', spreadOf(c, 'mrays_s')) +
      (c.ratio ? `; ${figure(c.ratio)} of ${embree}` : ''),
    `wrong per million: ${rateText(c)}${partly(c)}`];
  if (c.wrong_rays > 0)
    lines.push(`95 %: ${figure(c.ppm_lo)} to ${figure(c.ppm_hi)}; missed ${whole(c.missed)}, false ${whole(c.false)}, ` +
               `wrong t ${whole(c.wrong_t)}`);
  if (c.views === 1 && isNumber(t.node_tests_per_ray))
    lines.push(`${figure(t.node_tests_per_ray)} box and ${figure(t.prim_tests_per_ray)} primitive tests per ray: work ` +
               figure(t.work_per_ray));
  if (isNumber(b.build_ms_median))
    lines.push(`built in ${figure(b.build_ms_median)} ms (${figure(b.mprims_s)} Mprims/s)${b.untimed_ms > 0 ? `, and ${figure(b.untimed_ms)} ms not clocked` : ''}` +
               metrics.filter(m => isNumber(c.metrics[m.name])).map(m => `, ${m.title} ${figure(c.metrics[m.name])}`).join(''));
  if (isNumber(c.total)) lines.push(`build, layout and all ${brief(c.rays)} rays: ${figure(c.total)} ms`);
  return lines;
}

/* What draw() is told of a chart whose points are cells. */
const moreOf = (set, points, hover) => ({ of: [set.scene, set.rays, set.view].filter(Boolean).join(' '), hover,
                                          command: tracesCommand(points.map(p => p.cell.t)) });

/* ---- speed, and time, against wrong answers ---- */
const wrongAxis = range => axis(['wrong rays per million (log scale)', '\u2190 none found of n: at most 3/n'], true, range);

/* Room for the arrows on the left. */
const wrongRange = points => decades(points.flatMap(p => p.none ? [p.x, p.x / 1.4] : [p.x, p.xHigh]));

/* The checked cells as points; those on the Pareto front, which references are kept out of, are marked so. By the upper bound of
 * their rate, or one wrong ray of n would seem to beat none of n. */
function wrongPoints(cells, key, y, gain) {
  const points = cells.filter(c => isNumber(c.ppm) && isNumber(y(c))).map(c => ({
    cell: c, key: key(c), x: c.ppm, y: y(c), none: c.none, atMost: c.none, xLow: c.ppm_lo, xHigh: c.ppm_hi,
    cost: c.ppm_hi, gain: gain(c), front: false }));
  const front = paretoFront(points.filter(p => !p.cell.reference));
  for (const p of front) p.front = true;
  return [points, front];
}

/* Stairs through the front, from the end of the axis at which y is worst; never back to the left. */
function stairs(front, worst, right) {
  const steps = [];
  let x = 0, y = worst;
  for (const p of front) {
    x = Math.max(x, p.x);
    steps.push({ x, y }, { x, y: p.y });
    y = p.y;
  }
  return steps.concat(steps.length ? [{ x: right, y }] : []);
}

/* The marks of a chart as a table beside it; a row that is pointed at, or reached by the arrow keys, shows its mark. */
const tableStates = {};
function markTable(id, chart, points, columns) {
  const box = $(id), first = columns.findIndex(c => c.first);
  box.replaceChildren();
  tableStates[id] = tableStates[id] || { column: first, down: columns[first].down, words: [], odd: false };
  const again = commandColumn(p => cellCommand(p.cell));
  const table = addTable(box, 'The marks of the chart. The arrow keys go through them.', [...columns, again], points, {
    tools: true, state: tableStates[id], css: p => p.cell.reference ? 'reference' : null, compact: true });
  for (const [p, row] of table.rows) {
    row.tabIndex = -1;
    for (const [event, cell] of [['mouseenter', p.cell], ['focus', p.cell], ['mouseleave', null], ['blur', null]])
      row.addEventListener(event, () => pointAt(chart, cell));
  }
  table.region.addEventListener('keydown', event => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key], rows = [...table.region.querySelectorAll('tbody tr')];
    const at = rows.indexOf(event.target), next = rows[at < 0 ? 0 : at + (step || 0)];
    if (!step || !next || (at < 0 && event.target !== table.region)) return;
    event.preventDefault();
    next.focus();
  });
  return p => { for (const [point, row] of table.rows) row.classList.toggle('pointed', point === p); };
}

const wrongColumn = num('Wrong ppm', p => p.none ? 0 : p.cell.ppm, 'rays per million; \u2264: none found, at most 3/n',
  null);
wrongColumn.text = p => p.none ? `\u2264 ${figure(p.cell.ppm)}` : figure(p.cell.ppm);
wrongColumn.css = p => p.none ? '' : 'odd';
const frontColumn = { name: 'Front', title: 'on the Pareto front',
                      text: p => p.front ? 'on front' : p.cell.reference ? 'ref.' : dash };

/* What the upright lines of a chart are. */
function spreadNote(points) {
  const spreads = points.map(p => p.ySpread).filter(Boolean);
  const sure = spreads.some(s => s.isInterval), unsure = spreads.some(s => !s.isInterval);
  return (sure ? 'Upright lines at the marks are 95 % intervals of the median. ' : '') +
    (unsure ? 'Dashed upright lines at the marks are the range of the rounds, too few for a 95 % ' +
              'interval. ' : '');
}

function notes(set, cells, points) {
  const checked = unique(points.filter(p => p.none).map(p => p.cell.checked)).map(whole);
  return (checked.length ? `Here n is ${checked.slice(0, 4).join(' or ')}. ` : '') +
    (cells.length > points.length
      ? `Not drawn, since not checked or not measured: ${plural(cells.length - points.length, 'cell')}. ` : '') +
    (set.incomplete ? `${plural(set.incomplete, 'cell')} without a result in one of the views: choose a view. ` : '') +
    (points.length ? '' : 'No cell of this choice was traced and checked.');
}

function drawAccuracy(set, cells) {
  const tree = $('pick-tree').value, references = cells.filter(c => c.reference);
  const ours = cells.filter(c => !c.reference && (tree === '*' || tree === '' || c.label === tree));
  const checkedFirst = c => isNumber(c.ppm) ? c.mrays_s : -1;
  const drawn = tree === '' ? bestPer(ours, c => tracePart(c.t), checkedFirst) : ours;
  const [points, front] = wrongPoints(drawn.concat(references), kernelKey, c => c.mrays_s, c => c.mrays_s);
  for (const p of points) p.ySpread = spreadOf(p.cell, 'mrays_s');
  const range = wrongRange(points);
  const marks = marksOf(points, c => c.reference ? c.label : c.t.kernel, kernelColour);
  if (front.length) marks.push(line('Pareto front', stairs(front, 0, range.max)));
  $('accuracy-note').textContent =
    spreadNote(points) + notes(set, drawn.concat(references), points);
  const show = markTable('accuracy-table', 'chart-accuracy', points, [
    { name: 'Kernel', text: p => p.cell.t.kernel },
    { name: 'Intersector', text: p => p.cell.t.intersector || dash },
    Object.assign(num('Mrays/s', p => p.y), { first: true, down: true }), wrongColumn,
    num(`/${embree}`, p => p.cell.ratio, 'ratio to the fastest embree-native row on the same rays'), frontColumn,
    { name: 'Builder', text: p => p.cell.label }]);
  draw('chart-accuracy', 'Trace speed against wrong rays per million', marks,
       { x: wrongAxis(range), y: axis('Mrays/s', false, { beginAtZero: true, grace: '5%' }) },
       p => p.cell ? [p.cell.label].concat(cellLines(p.cell)) : '', moreOf(set, points, show));
}

function drawBuilders(set, cells) {
  const drawn = bestPer(cells.filter(c => isNumber(c.ppm) && isNumber(c.total)),
                        c => JSON.stringify([c.label, c.t.intersector]), c => -c.total);
  const [points, front] = wrongPoints(drawn, builderKey, c => c.total, c => -c.total);
  const range = wrongRange(points), ms = decades(points.map(p => p.y));
  const marks = marksOf(points, c => c.label, builderColour);
  if (front.length) marks.push(line('Pareto front', stairs(front, ms.max, range.max)));
  $('builders-note').textContent = notes(set, drawn, points);
  const show = markTable('builders-table', 'chart-builders', points, [
    { name: 'Builder', text: p => p.key },
    Object.assign(num('Total ms', p => p.y, 'boxes, build, transfer, layout and all rays'), { first: true, down: false }), wrongColumn, frontColumn, num('Build ms', p => p.cell.t.record.build_ms_median),
    num('First ray ms', p => p.cell.fixed_ms, 'boxes, build, transfer and layout'),
    Object.assign(num('Other ms', p => p.cell.fixed_ms - p.cell.t.record.build_ms_median), { title: 'boxes, transfer, layout' }),
    { name: 'Intersector', text: p => p.cell.t.intersector || dash },
    { name: 'Kernel', text: p => p.cell.t.kernel }]);
  draw('chart-builders', 'Time for build, layout and rays against wrong rays per million', marks,
       { x: wrongAxis(range), y: axis('ms (log scale)', true, ms) }, p => p.cell ? cellLines(p.cell) : '', moreOf(set, points, show));
}

/* ---- time to n rays ---- */
const timeAt = (cells, n) => cells.reduce((best, c) => !best || c.fixed_ms + n * c.msPerRay < best.ms
  ? { ms: c.fixed_ms + n * c.msPerRay, cell: c } : best, null);

function winnerItem(winners, i) {
  const c = winners[i].cell, next = winners[i + 1];
  const range = winners.length === 1 ? 'for every n' : i === 0 ? `up to ${brief(next.from)} rays`
                                                               : `from ${brief(winners[i].from)} rays`;
  return el('li', {}, el('b', {}, `${builderKey(c)} ${range}`),
    `: ${c.label}, ${madeOf(c)} (${figure(c.fixed_ms)} ms before the first ray, then ${figure(c.msPerRay * 1e6)} ns per ray; ` +
    `wrong per million: ${rateText(c)}${partly(c)})`);
}

function drawTime(set, cells) {
  const usable = cells.filter(c => c.usable && isNumber(c.fixed_ms)), ours = usable.filter(c => !c.reference);
  const winners = winnersOf(ours), last = winners.length ? winners[winners.length - 1].from : 0;
  const rays = usable.length ? usable[0].rays : 1;
  /* from the first ray, which waits for what comes before it, to 10^9, and well beyond the last crossing */
  const min = 1, max = 10 ** Math.ceil(Math.log10(Math.min(Math.max(1e9, last * 30), 1e13)) - 1e-9);
  const steps = Array.from({ length: 121 }, (_, i) => min * (max / min) ** (i / 120));
  const curves = unique(usable.map(c => c.label)).map((name, i) => {
    const own = usable.filter(c => c.label === name);
    const points = steps.map(n => { const at = timeAt(own, n); return { x: n, y: at.ms, cell: at.cell }; });
    for (const end of [points[0], points[steps.length - 1]]) end.key = builderKey(own[0]);
    return line(name, points, { own: builderColour(own[0]), width: own[0].reference ? 1.5 : 2, hasTip: true,
      pointHitRadius: 6, borderDash: against ? (isOld(name) ? [8, 4] : []) : [[], [8, 4], [2, 3], [10, 3, 2, 3], [5, 5]][i % 5], clip: 0 });
  });
  const overtaken = winners.filter((w, i) => i > 0 && w.cell.label !== winners[i - 1].cell.label && w.from > 0);
  const crossings = overtaken.map(w => ({ x: w.from, y: w.cell.fixed_ms + w.from * w.cell.msPerRay, cell: w.cell, front: true,
                                                 below: true, key: `${builderKey(w.cell)} from ${brief(w.from)}` }));
  const crossed = { label: 'overtakes', data: crossings, pointRadius: 4, pointBackgroundColor: theme().text,
                    pointBorderColor: theme().text, order: -1 };
  $('time-note').textContent = usable.length ? `All rays of this choice are ${whole(rays)}.`
                                             : 'No build and trace of this choice can be combined.';
  $('winners').replaceChildren(...winners.map((_, i) => winnerItem(winners, i)));
  draw('chart-time', 'Time to n rays per builder', curves.concat([crossed]),
       { x: axis('n, rays traced (log scale)', true, { min, max }), y: axis('ms (log scale)', true, {}) },
       p => [`${brief(p.x)} rays: ${figure(p.y)} ms`, madeOf(p.cell), `${figure(p.cell.fixed_ms)} ms before the first ray, then ` +
             `${figure(p.cell.msPerRay * 1e6)} ns per ray`, `wrong per million: ${rateText(p.cell)}${partly(p.cell)}`],
       moreOf(set, usable.map(cell => ({ cell }))));
}

/* ---- what is said of the tree, and what building it costs ---- */
function drawQuality(set, cells) {
  const metric = measures.find(m => m.name === $('pick-metric').value), name = metric.title;
  const points = cells.filter(c => !c.reference).map(c => ({
    cell: c, key: builderKey(c), x: c.metrics[metric.name], y: c.mrays_s, none: c.none,
    ySpread: spreadOf(c, 'mrays_s') }));
  const sets = marksOf(points, c => c.label, builderColour), xs = sets.flatMap(s => s.data).map(p => p.x);
  const rate = Math.max(0, ...cells.filter(c => isReference(c.builder)).map(c => c.mrays_s));
  if (rate > 0 && xs.length > 0)
    sets.push(line('fastest embree-native', [{ x: Math.min(...xs), y: rate }, { x: Math.max(...xs), y: rate }],
                   { borderDash: [6, 4] }));
  $('quality-note').textContent = spreadNote(sets.flatMap(s => s.data)) +
    'Filled marks gave wrong answers.' +
    (rate > 0 && xs.length ? ' Dashed: the fastest embree-native row, whose tree is not seen.' : '') +
    (xs.length ? '' : ` ${name} was not measured here.`);
  draw('chart-quality', `Trace speed against ${name}`, sets,
       { x: axis([name, metric.unit].filter(Boolean).join(', '), false, { grace: '5%' }), y: axis('Mrays/s', false, { beginAtZero: true, grace: '5%' }) },
       p => p.cell ? cellLines(p.cell) : '', moreOf(set, points));
}

function drawBuild(set, cells) {
  const best = bestPer(cells.filter(c => c.usable), c => c.label, c => c.mrays_s);
  const points = best.map(c => ({ cell: c, key: builderKey(c), x: c.t.record.mprims_s, y: c.mrays_s, none: c.none,
                                  ySpread: spreadOf(c, 'mrays_s') }));
  const sets = marksOf(points, c => c.label, builderColour);
  $('build-note').textContent = spreadNote(sets.flatMap(s => s.data));
  draw('chart-build', 'Build speed against trace speed', sets,
       { x: axis('Mprims/s built (log scale)', true, decades(sets.flatMap(s => s.data).map(p => p.x))),
         y: axis('Mrays/s', false, { beginAtZero: true, grace: '5%' }) }, p => cellLines(p.cell), moreOf(set, points));
}

/* ---- how the time per primitive grows with the scene ---- */

/* Builds of one builder on scenes of one family (what stands before the parameters of a name), by size; of the same build the least
 * time. */
function growthLines() {
  const size = new Map(data.scenes.map(s => [s.name, s.prims])), lines = new Map();
  for (const b of builds) {
    if (b.status !== 'ok' || !isNumber(b.build_ms_median) || !(size.get(b.scene) > 0)) continue;
    const name = label(b), family = b.scene.split(':')[0], key = JSON.stringify([name, family]);
    const own = lines.get(key) || { name, family, points: new Map() }, x = size.get(b.scene);
    const y = b.build_ms_median * 1e6 / x, other = own.points.get(x);
    if (!other || y < other.y) own.points.set(x, { x, y, build: b });
    lines.set(key, own);
  }
  return [...lines.values()].filter(l => l.points.size > 1);
}

function drawGrowth() {
  const all = growthLines(), names = unique(all.map(l => l.name)), families = unique(all.map(l => l.family));
  $('growth').hidden = all.length === 0;
  if (all.length === 0) return;
  const sets = all.map(l => {
    const points = [...l.points.values()].sort((a, b) => a.x - b.x), colour = colourAt(names.indexOf(l.name));
    points[points.length - 1].key = l.name;
    return line(`${l.name}, ${l.family}`, points, { own: colour, width: 1.5, pointRadius: 3, pointHitRadius: 8,
      hasTip: true, borderDash: [[], [8, 4], [2, 3]][families.indexOf(l.family) % 3] });
  });
  draw('chart-growth', 'Build time per primitive against the number of primitives', sets,
       { x: axis('primitives (log scale)', true, decades(sets.flatMap(s => s.data).map(p => p.x))),
         y: axis('ns per primitive (log scale)', true, decades(sets.flatMap(s => s.data).map(p => p.y))) },
       p => [`${whole(p.x)} primitives: ${figure(p.y)} ns each`,
             measured(p.build.build_ms_median, 'ms', spreadOf(p.build, 'build_ms')),
             p.build.scene],
       { of: '', command: buildsCommand(sets.flatMap(s => s.data.map(p => p.build))) });
}

function drawAll(set) {
  const cells = set.cells.filter(shown);
  for (const chart of [drawAccuracy, drawBuilders, drawTime, drawQuality, drawBuild, drawPrediction]) chart(set, cells);
}
