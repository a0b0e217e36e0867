/* The atlas: a table of thresholds, axis by method, and the figures along an axis. All text of the figures goes through textContent. */
const read = id => JSON.parse(document.getElementById(id).textContent);

/* The table's rows: the run, methods, axes, values of axes and what is simulated there, failures. */
function atlasOf(rows) {
  const nameOf = row => row.builder ?? row.intersector, run = rows.find(r => !nameOf(r) && !r.question);
  const methods = rows.filter(r => r.part).map(r => ({ part: r.part, name: nameOf(r) }));
  const index = row => methods.findIndex(m => m.name === nameOf(row) && (m.part === 'builder') === (row.builder !== undefined));
  const axes = rows.filter(r => r.title).map(axis => ({ ...axis, name: axis.question, values: [], thresholds: [] }));
  for (const row of rows.filter(r => r.question && nameOf(r))) {
    const axis = axes.find(a => a.name === row.question);
    if (row.maker && row.word) {
      axis.thresholds.push({ ...row, method: index(row), manner: row.maker });
    } else if (row.maker) {
      axis.values.find(v => v.frame === row.frame).methods[index(row)].simulated[row.maker] = row;
    } else {
      if (!axis.values.some(v => v.x === row.x)) axis.values.push({ x: row.x, frame: row.frame, methods: [] });
      axis.values.find(v => v.x === row.x).methods[index(row)] = { ...row, simulated: {} };
    }
  }
  return { run, methods, axes };
}

const atlas = atlasOf(read('data').rows), run = atlas.run, pictures = read('pictures');
const parts = { builder: 'Builders', kernel: 'Kernels', intersector: 'Intersectors' };
const simulations = [...new Set(atlas.axes.flatMap(a => a.values.flatMap(v => v.methods.flatMap(m => Object.keys(m.simulated)))))];
const charts = {}, hidden = new Set();

function brief(value) {
  if (!isNumber(value)) return dash;
  const size = Math.abs(value);
  return size !== 0 && (size < 0.01 || size >= 1e5) ? value.toExponential(1).replace('.0e', 'e').replace('e+', 'e')
                                                      : String(Number(value.toPrecision(3)));
}

const methodsOf = part => atlas.methods.map((m, index) => ({ ...m, index })).filter(m => m.part === part);
const axisNamed = name => atlas.axes.find(a => a.name === name);

/* ---- the table ---- */

/* The first failure of a method along an axis, in the manner that is chosen. */
function firstOf(axis, method, manner) {
  const down = axis.from > axis.to;
  const order = t => t.from_start ? -Infinity : down ? -t.at : t.at;
  const found = axis.thresholds.filter(t => t.method === method && (!manner || t.manner === manner));
  return found.sort((a, b) => order(a) - order(b))[0];
}

const short = { crashed: 'crash', hung: 'hang', memory: 'memory', failed: 'fails', wrong: 'wrong', overflowed: 'stack', refused: 'refused', rebuilt: 'rebuilt',
                bigger: 'bigger', 'more-tests': 'tests', 'slow-trace': 'trace', 'slow-build': 'build' };
const kindOf = manner => ['crashed', 'hung', 'memory', 'failed'].includes(manner) ? 'crash' : manner;

function entryOf(axis, method, manner) {
  const t = firstOf(axis, method, manner);
  const verdict = axis.values.some(v => v.methods[method]);
  if (!t) return el('td', { class: 'fine', title: verdict ? 'no such failure on this axis' : 'not measured' }, verdict ? dash : '?');
  const from = !t.from_start ? brief(t.at) : t.returns ? 'some' : 'all';
  const title = `${t.word} ${t.from_start ? 'from the first value on' : `from ${brief(t.at)} on; not at ${brief(t.below)}`}` +
                `${isNumber(t.ratio) ? `; ${brief(t.ratio)} times` : ''}${t.returns ? '; not throughout' : ''}`;
  const button = el('button', { type: 'button', title }, `${short[t.manner]} ${from}`);
  button.addEventListener('click', () => { $('pick-axis').value = axis.name; showAxis(); $('axis-title').scrollIntoView(); });
  return el('td', { class: t.manner === 'wrong' && axis.known ? 'known' : kindOf(t.manner) }, button);
}

function showTable() {
  const methods = methodsOf($('pick-part').value), manner = $('pick-manner').value;
  const head = el('tr', {}, el('th', { scope: 'col' }, 'Axis'), ...methods.map(m => el('th', { scope: 'col' }, m.name)));
  const rows = atlas.axes.map(axis => el('tr', {}, el('th', { scope: 'row', title: axis.title }, axis.name),
                                         ...methods.map(m => entryOf(axis, m.index, manner))));
  $('table').replaceChildren(el('table', { class: 'atlas' }, el('thead', {}, head), el('tbody', {}, ...rows)));
}

/* ---- an axis ---- */

const colour = (index, count) => `hsl(${Math.round(360 * index / count)} 65% ${matchMedia('(prefers-color-scheme: dark)').matches ? 65 : 38}%)`;
const theme = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

const units = { wrong: 'wrong rays per million', trace: 'ns per ray', metric: 'metric of the tree (no unit)', build: 'ns per primitive',
                simt: 'Mrays/s, simulated', efficiency: 'active lanes per lane issued, simulated' };
const figures = {
  wrong: f => isNumber(f.wrong) && f.checked > 0 ? Math.max(1e6 * f.wrong / f.checked, 0) : NaN,
  trace: f => 1e6 * f.trace_ms / f.rays,
  metric: f => f.metric,
  build: f => 1e6 * f.build_ms / f.prims,
  simt: f => f.simulated[$('pick-simulation').value]?.simt_mrays_s,
  efficiency: f => f.simulated[$('pick-simulation').value]?.simt_efficiency,
};

/* A logarithmic axis has no place for 0: what lies there stands beside the least value. */
function placeOf(axis) {
  const positive = axis.values.map(v => v.x).filter(x => x > 0), log = axis.steps !== 'linear' && positive.length > 1;
  const least = Math.min(...positive);
  return { log, at: x => log && x <= 0 ? least / 10 : x };
}

function drawOne(id, axis, methods) {
  const value = figures[id], { log, at } = placeOf(axis);
  const floor = 1e6 / run.rays_per_set / 4;
  const datasets = methods.filter(m => !hidden.has(m.name)).map(m => {
    const own = colour(methods.indexOf(m), methods.length);
    const points = axis.values.filter(v => v.methods[m.index]).map(v => ({ x: at(v.x), true_x: v.x, y: value(v.methods[m.index]) }))
      .filter(p => isNumber(p.y)).map(p => ({ ...p, shown: p.y, y: id === 'wrong' ? Math.max(p.y, floor) : p.y }));
    return { label: m.name, data: points, showLine: true, borderColor: own, backgroundColor: own, borderWidth: 1.5, pointRadius: 3, tension: 0 };
  }).filter(set => set.data.length > 0);
  if (charts[id]) charts[id].destroy();
  $(`chart-${id}`).setAttribute('aria-label', `${id} along ${axis.name}, ${datasets.length} methods`);
  const grid = { color: theme('--line') }, ticks = { color: theme('--muted'), maxTicksLimit: 8, callback: v => brief(v) };
  charts[id] = new Chart($(`chart-${id}`), {
    type: 'scatter', data: { datasets },
    options: {
      animation: false, responsive: true, maintainAspectRatio: false,
      scales: {
        x: { type: log ? 'logarithmic' : 'linear', reverse: axis.from > axis.to, grid, ticks,
             title: { display: true, text: axis.parameter, color: theme('--text') } },
        y: { type: 'logarithmic', min: id === 'wrong' ? floor : undefined, grid, ticks, title: { display: true, text: units[id], color: theme('--text') } },
      },
      plugins: {
        legend: { display: false },
        tooltip: { callbacks: { label: item => `${item.dataset.label}: ${brief(item.raw.shown)} at ${brief(item.raw.true_x)}` } },
      },
    },
  });
}

function showLegend(methods) {
  $('legend').replaceChildren(...methods.map((m, i) => {
    const dot = el('i');
    dot.style.background = colour(i, methods.length);
    const button = el('button', { type: 'button', 'aria-pressed': String(!hidden.has(m.name)) }, dot, m.name);
    button.addEventListener('click', () => {
      if (!hidden.delete(m.name)) hidden.add(m.name);
      showAxis();
    });
    return button;
  }));
}

function showFailures(axis, methods) {
  const rows = methods.flatMap(m => axis.thresholds.filter(t => t.method === m.index).map(t => {
    const here = axis.values.find(v => v.x === t.at), f = here && here.methods[m.index];
    const much = isNumber(t.ratio) ? `${brief(t.ratio)} times` : f && f.reason ? f.reason
               : t.manner === 'wrong' && f ? `${brief(1e6 * f.wrong / f.checked)} ppm` : '';
    return el('tr', {}, el('th', { scope: 'row' }, m.name), el('td', {}, t.word), el('td', {}, t.from_start ? 'the first value' : brief(t.at)),
              el('td', {}, t.from_start ? '' : brief(t.below)), el('td', {}, much + (t.returns ? ' (not throughout)' : '')));
  }));
  const head = ['Method', 'Fails', 'from', 'not yet at', 'there'].map(text => el('th', { scope: 'col' }, text));
  $('axis-table').replaceChildren(rows.length === 0 ? el('p', {}, 'None of these methods fails on this axis.')
    : el('table', { class: 'atlas' }, el('thead', {}, el('tr', {}, ...head)), el('tbody', {}, ...rows)));
}

function showAxis() {
  const axis = axisNamed($('pick-axis').value), methods = methodsOf($('pick-part').value);
  const scene = axis.family.replaceAll('{n}', String(axis.n));
  $('axis-title').textContent = axis.title;
  $('axis-why').textContent = axis.why;
  $('axis-known').textContent = axis.known || '';
  $('axis-known').hidden = !axis.known;
  $('axis-what').textContent = `x is the ${axis.parameter}, from ${brief(axis.from)} to ${brief(axis.to)}, in scene ${scene} and rays ` +
    `${axis.ray_families}. Kernels and intersectors trace the trees of ${axis.traced_tree}; builders and intersectors are traced by ` +
    `${axis.traced_by}.`;
  const picture = pictures[axis.picture];
  $('axis-figure').hidden = !picture;
  if (picture) {
    $('axis-picture').src = picture;
    $('axis-picture').alt = `The scene at ${brief(axis.picture_at)}`;
    $('axis-caption').textContent = `The scene at ${brief(axis.picture_at)}`;
  }
  showFailures(axis, methods);
  showLegend(methods);
  for (const id of Object.keys(figures)) if (!$(`chart-${id}`).closest('[hidden]')) drawOne(id, axis, methods);
}

/* ---- the page ---- */

function fill(id, options) {
  $(id).replaceChildren(...options.map(([value, text]) => el('option', { value }, text)));
}

function start() {
  const used = [...new Set(atlas.methods.map(m => m.part))];
  $('where').textContent = `${run.revision}, ${run.device || 'no device'}: ${atlas.methods.length} methods on ${atlas.axes.length} axes, up to ` +
    `${run.rays_per_set} rays a set, ${Math.round(run.total_ms / 1000)} s${run.quick ? ' (--quick: few values, small scenes, times not judged)' : ''}`;
  const cut = atlas.axes.length === 0 || atlas.axes.some(a => a.complete !== 'yes');
  $('bugs').textContent = cut ? `Interrupted: not all was measured. ${run.bugs} bugs so far.` : run.bugs === 0 ? 'No crash, no hang, no failure, and no wrong answer of what must be exact.'
    : `${run.bugs} bugs: a crash, a hang, a failure, or wrong answers of what must be exact.`;
  if (run.bugs > 0) $('bugs').firstChild.replaceWith(el('b', { class: 'bad' }, $('bugs').textContent));
  $('metric-title').textContent = run.metric_of_trees;
  fill('pick-part', used.map(part => [part, parts[part]]));
  const manners = [...new Map(atlas.axes.flatMap(a => a.thresholds.map(t => [t.manner, t.word])))];
  fill('pick-manner', [['', 'all'], ...manners]);
  fill('pick-axis', atlas.axes.map(a => [a.name, `${a.name}: ${a.title}`]));
  const facts = ['date', 'revision', 'host', 'cpu', 'device', 'driver', 'build_flags', 'seed', 'command'];
  $('context').replaceChildren(...facts.filter(name => (run[name] ?? '') !== '').map(name =>
    el('div', {}, el('dt', {}, name), el('dd', {}, String(run[name])))));
  fill('pick-simulation', simulations.map(name => [name, name]));
  $('simulated').hidden = simulations.length === 0;
  for (const id of ['pick-part', 'pick-manner', 'pick-axis', 'pick-simulation'])
    $(id).addEventListener('change', () => { showTable(); showAxis(); });
  if (atlas.axes.length === 0) return;
  showTable();
  showAxis();
}
start();
