/* The page's head, its sections, and what happens when something is chosen. */
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
  $('summary').append(
    `${plural(data.scenes.length, 'scene')}, ${plural(builds.length, 'build')}, ${plural(done, 'cell')} traced; `,
    done === 0 ? '' : el('span', { class: bad ? 'bad' : null },
       bad ? `${plural(bad, 'cell')} WRONG above the limit` : 'no cell above the limit for wrong answers'),
    (inexact ? `; ${plural(inexact, 'other cell')} with wrong answers (references, inexact, or within the limit)` : '') +
    (missing ? `; ${plural(missing, 'row')} without a result` : '') + (skipped ? `; ${skipped} skipped` : '') + '.');
  $('answer').hidden = $('summary').hidden = builds.length === 0; // a paper that compares no builds and rays
  for (const id of ['charts', 'traces']) $(id).hidden = $(id + '-link').hidden = traces.length === 0;
  const texts = {
    date: c.date && c.date.replace('T', ' ').replace('Z', ' UTC'),
    cpu: c.cpu && c.cpu_threads ? `${c.cpu}, ${c.cpu_threads} threads` : c.cpu,
    embree_version: [c.embree_version, c.embree_api].filter(Boolean).join(', '),
  };
  const entries = names => names.map(name => [schema.context[name].heading, name in texts ? texts[name] : c[name]]);
  contextList($('context'), entries(['date', 'revision', 'host', 'cpu', 'device', 'driver', 'opencl', 'seed']));
  contextList($('more-context').querySelector('dl'),
              entries(['build_flags', 'kernels', 'compute_units', 'float_config', 'embree_version', 'governor', 'smt', 'boost', 'processors', 'load_1', 'load_5', 'load_15', 'command']));
  (data.merged || []).forEach((m, i) => contextList($('more-context').querySelector('dl'), [
    [`Run ${i + 2}`, [m.date, m.revision, m.host, m.device].filter(Boolean).join(', ')],
    [`Command of run ${i + 2}`, m.command]]));
  $('where').textContent = [texts.cpu, c.device, c.revision, texts.date].filter(Boolean).join(' \u00b7 ');
  for (const [id, rows] of [['traces', traces], ['builds', builds], ['scenes', data.scenes]])
    $(`${id}-fold`).textContent = `The table: ${plural(rows.length, 'row')}`;
  $('version').textContent = [c.version, c.revision].filter(Boolean).join(', revision ');
  document.title = `bvhbench report, ${data.scenes.map(s => s.name).join(', ')}`;
}

/* ---- papers reproduced ---- */
const marks = { held: ['held', '\u2713'], 'direction only': ['open', '~'], 'not held': ['failed', '\u2717'] };

/* As in the record: numbers, texts, or nothing. */
const entry = value => typeof value === 'number' ? figure(value) : value ?? dash;

function claimItem(claim) {
  const [css, mark] = marks[claim.verdict] || ['open', '?'];
  const details = [['Paper', claim.paper], ['Figures', claim.claimed], ['Here', claim.ours], ['Why', claim.why]].filter(([, value]) => (value ?? '') !== '');
  return el('li', {}, el('span', { class: `verdict ${css}` }, `${mark} ${claim.verdict}`), ' ', String(claim.claim),
            el('dl', {}, ...details.flatMap(([name, value]) => [el('dt', {}, name), el('dd', {}, String(value))])));
}

function reproductions() {
  const list = data.reproductions || [];
  $('papers').hidden = $('papers-link').hidden = list.length === 0;
  for (const r of list) {
    $('papers').append(el('h3', {}, r.title || r.name));
    if ((r.claims || []).length > 0) $('papers').append(el('ul', { class: 'claims' }, ...r.claims.map(claimItem)));
    for (const table of r.tables || []) {
      const columns = table.columns.map((name, i) => ({ name, number: table.rows.some(row => typeof row[i] === 'number'),
        value: row => row[i], text: row => entry(row[i]) }));
      addTable($('papers'), table.title || r.title || r.name, columns, table.rows, {});
    }
  }
}
function pictureGrid() {
  if (pictures.length === 0) $('pictures').append(el('p', { class: 'note' }, 'The run made no pictures.'));
  $('pictures').append(el('div', { class: 'pictures' }, ...pictures.map(p => {
    const text = [p.scene, p.view, p.caption].filter(Boolean).join(', ');
    const picture = p.src ? el('img', { src: p.src, alt: text }) : el('p', { class: 'notice' }, `${p.path}: ${p.missing}`);
    return el('figure', {}, picture, el('figcaption', {}, text));
  })));
}

/* What each metric is, and a choice of it. */
function metricTexts() {
  $('after-metrics').before(...schema.metrics.flatMap(m => [el('dt', {}, m.title), el('dd', {}, m.summary)]));
  $('pick-metric').replaceChildren(...measures.map(m =>
    el('option', { value: m.name, selected: m.of_layouts }, m.summary ? `${m.title} of the ${m.of_layouts ? 'layout as traced' : 'tree'}` : m.title)));
}

/* ---- what is chosen ---- */
let current;

function legendButton(kind, name, colour) {
  const button = seriesButton(name, colour, { 'aria-pressed': !hidden[kind].has(name) + '' });
  button.addEventListener('click', () => {
    if (!hidden[kind].delete(name)) hidden[kind].add(name);
    button.setAttribute('aria-pressed', !hidden[kind].has(name) + '');
    drawAll(current);
  });
  return button;
}

/* One button per builder and kernel of the set, and what the shapes mean. */
function drawLegend(set) {
  const first = (cells, name) => unique(cells.map(name)).map(n => cells.find(c => name(c) === n));
  const builders = first(set.cells, c => c.label), kernels = first(set.cells.filter(c => !c.reference), c => c.t.kernel);
  const intersectors = first(set.cells.filter(c => !c.reference), c => c.t.intersector || dash);
  $('legend-kernels').replaceChildren(...kernels.map(c =>
    legendButton('kernel', c.t.kernel, kernelColour(c))));
  $('legend-builders').replaceChildren(...builders.map(c =>
    legendButton('builder', c.label, builderColour(c))));
  $('shapes').textContent = 'Marks: ' + intersectors.map(c => `${shapeOf(c)[2]} ${c.t.intersector || dash}`)
    .concat(set.cells.some(c => c.reference) ? [`\u2715 tracers with trees of their own`] : []).join('   ') +
    '. Filled: wrong answers found; hollow: none.';
  const tree = $('pick-tree'), chosen = tree.value, names = builders.filter(c => !c.reference).map(c => c.label);
  tree.replaceChildren(el('option', { value: '' }, 'the fastest for each kernel'), el('option', { value: '*' }, 'of all builders'),
                       ...names.map(name => el('option', { value: name }, `of ${name}`)));
  tree.value = ['', '*', ...names].includes(chosen) ? chosen : '';
}

function redraw() {
  drawGrowth();
  current = pick();
  drawLegend(current);
  drawAll(current);
}

/* What a link leads to is unfolded. */
function unfold() {
  const target = location.hash.length > 1 && !location.hash.startsWith('#choice:') && $(location.hash.slice(1));
  for (const details of target ? target.querySelectorAll('details.fold') : []) details.open = true;
}

Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
readAddress();
for (const part of [head, startVerdict, startAgainst, reproductions, traceTable, buildTable, sceneTable, stepTable, pictureGrid, metricTexts, startPrediction]) part();
redraw();
for (const [id, key] of [['pick-scene', 'scene'], ['pick-rays', 'rays'], ['pick-view', 'view']])
  $(id).addEventListener('change', event => { picked[key] = event.target.value; redraw(); writeAddress(); });
for (const id of ['pick-tree', 'pick-metric', 'pick-cost']) $(id).addEventListener('change', () => drawAll(current));
const redrawAll = () => { drawVerdict(); redraw(); };
dark.addEventListener('change', redrawAll);
window.addEventListener('hashchange', unfold);
unfold();
/* On paper nothing is folded. */
let folded = [];
window.addEventListener('beforeprint', () => {
  printing = true;
  folded = [...document.querySelectorAll('details.fold:not([open])')];
  for (const details of folded) details.open = true;
  redrawAll();
});
window.addEventListener('afterprint', () => {
  printing = false;
  for (const details of folded) details.open = false;
  redrawAll();
});
