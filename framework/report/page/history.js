/* The page of the history: a machine, a cell, a figure; its chart over the revisions, with marks where it moved; all that moved. All
 * text of the records goes through textContent. */
const data = JSON.parse(document.getElementById('data').textContent);
const dark = window.matchMedia('(prefers-color-scheme: dark)');
const ROWS = 500;

const share = value => `${Number((100 * value).toPrecision(3))} %`;
const day = date => (date || '').replace('T', ' ').replace('Z', ' UTC');

let machine, cell, what;

/* ---- what is chosen ---- */
const machineName = m => [m.host, m.cpu, m.device, m.driver].filter(Boolean).join(', ');
const isTime = () => what === 'ms';
const valueOf = point => isTime() ? point.ms : point.figures[what];
const movesOf = c => c.moves.filter(m => m.what === what);

/* The 95 % interval of the median; of too few rounds for one, their range. */
function spreadOf(point) {
  if (!isTime()) return null;
  if (isNumber(point.lo) && isNumber(point.hi)) return { low: point.lo, high: point.hi, isInterval: true };
  if (isNumber(point.least) && isNumber(point.most)) return { low: point.least, high: point.most, isInterval: false };
  return null;
}

/* What moved last, and worst, comes first. */
const latest = c => Math.max(-1, ...c.moves.map(m => m.at));
const rank = m => ['worse', 'better', 'undecided', 'changed'].indexOf(m.verdict);

function fillCells() {
  const words = $('filter').value.toLowerCase().split(/\s+/).filter(Boolean);
  const shown = machine.cells.filter(c => words.every(word => c.name.toLowerCase().includes(word)));
  $('pick-cell').replaceChildren(...shown.map(c =>
    el('option', { value: c.key }, c.moves.length ? `${c.name} (moved)` : c.name)));
  if (shown.length === 0) return;
  if (!shown.includes(cell)) cell = shown.reduce((a, b) => latest(b) > latest(a) ? b : a);
  $('pick-cell').value = cell.key;
}

function fillFigures() {
  const names = new Set(cell.points.flatMap(p => Object.keys(p.figures)));
  const choices = [...(cell.points.some(p => isNumber(p.ms)) ? ['ms'] : []), ...[...names].sort()];
  $('pick-figure').replaceChildren(...choices.map(name => el('option', { value: name }, name === 'ms' ? 'time in ms' : name)));
  if (!choices.includes(what)) what = choices[0];
  $('pick-figure').value = what;
}

/* ---- the chart ---- */
let chart;
const colour = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function series() {
  const at = new Map(cell.points.map(p => [p.at, p]));
  const every = f => machine.revisions.map((_, i) => at.has(i) ? f(at.get(i)) ?? null : null);
  const marks = verdict => {
    const moved = new Set(movesOf(cell).filter(m => m.verdict === verdict).map(m => m.at));
    return machine.revisions.map((_, i) => moved.has(i) && at.has(i) ? valueOf(at.get(i)) : null);
  };
  const mark = (verdict, label, name, rotation) => ({ label, data: marks(verdict), showLine: false, pointStyle: 'triangle',
    rotation, radius: 9, hoverRadius: 9, borderColor: colour(name), backgroundColor: colour(name) });
  const band = { borderWidth: 0, pointRadius: 0, pointHitRadius: 0, spanGaps: true, isBand: true };
  return [
    mark('worse', 'worse', '--bad', 0),
    mark('better', 'better', '--good', 180),
    mark('changed', 'changed', '--muted', 90),
    { label: isTime() ? 'median' : what, data: every(valueOf), borderColor: colour('--accent'), backgroundColor: colour('--accent'),
      borderWidth: 2, radius: 4, spanGaps: true },
    { ...band, label: 'upper end', data: every(p => spreadOf(p)?.high), fill: '+1', backgroundColor: colour('--accent') + '33' },
    { ...band, label: 'lower end', data: every(p => spreadOf(p)?.low), fill: false },
  ];
}

function drawChart() {
  const text = colour('--text'), line = colour('--line'), unit = isTime() ? 'ms' : what;
  const axis = title => ({ title: { display: true, text: title, color: text }, ticks: { color: text }, grid: { color: line } });
  if (chart) chart.destroy();
  chart = new Chart($('chart'), {
    type: 'line',
    data: { labels: machine.revisions.map(r => r.revision), datasets: series() },
    options: {
      animation: false, responsive: true, maintainAspectRatio: false,
      interaction: { mode: 'index', intersect: false },
      scales: { x: axis('revision'), y: { ...axis(unit), grace: '10%' } },
      plugins: {
        legend: { labels: { color: text, usePointStyle: true, filter: item => !/ end$/.test(item.text) } },
        tooltip: { filter: item => !item.dataset.isBand, callbacks: {
          label: item => `${item.dataset.label}: ${figure(item.raw)} ${isTime() ? 'ms' : ''}`,
          footer: items => items.length ? day(machine.revisions[items[0].dataIndex].date) : '' } },
      },
    },
  });
  const spreads = cell.points.map(spreadOf).filter(Boolean), moves = movesOf(cell);
  $('chart-title').textContent = cell.name;
  $('chart').setAttribute('aria-label', `${cell.name}, ${unit}: ${cell.points.length} revisions, ${moves.length} marks`);
  $('chart-note').textContent = (spreads.length === 0 ? '' : spreads.every(s => s.isInterval)
    ? 'The band is the 95 % interval of the median. '
    : spreads.some(s => s.isInterval) ? 'The band is the 95 % interval of the median; of fewer than 6 rounds, their range. '
    : 'The band is the range of the rounds: fewer than 6 have no interval. ') +
    (isTime() ? `Triangles: the ratio to what was known before excludes 1, is beyond ${share(machine.floor ?? data.assumed)}, ` +
      `and p for all cells of that revision together is at most ${share(data.level)}.` : 'Triangles: it is another figure than before.');
}

/* ---- tables ---- */
const cellText = value => value instanceof Node ? value : String(value);
function table(node, headings, rows) {
  node.replaceChildren(
    el('thead', {}, el('tr', {}, ...headings.map(h => el('th', { scope: 'col' }, h)))),
    el('tbody', {}, ...rows.map(row => el('tr', {}, ...row.map(([value, css]) => el('td', { class: css }, cellText(value)))))));
}

const movedText = m => m ? `${m.verdict}${isNumber(m.ratio) ? `, ${figure(m.ratio)} times` : ''}` : '';

function drawRevisions() {
  const rows = cell.points.map(p => {
    const r = machine.revisions[p.at], s = spreadOf(p), m = movesOf(cell).find(move => move.at === p.at);
    const status = cell.moves.find(move => move.at === p.at && move.what === 'status');
    return [[r.revision, 'key'], [day(r.date)], [figure(valueOf(p)), 'number'],
            [s ? `${figure(s.low)} to ${figure(s.high)}${s.isInterval ? '' : ' (range)'}` : ''],
            [p.status, status ? status.verdict : null], [movedText(m), m ? m.verdict : null]];
  });
  table($('revisions'), ['Revision', 'Date', isTime() ? 'Median ms' : what, isTime() ? '95 %' : '', 'Status', 'Moved'], rows.reverse());
}

function choose(c, name) {
  cell = c;
  if (name !== 'status') what = name;
  $('filter').value = '';
  draw();
  $('cell').scrollIntoView();
}

function drawMoves() {
  const all = machine.cells.flatMap(c => c.moves.map(m => ({ c, m })));
  const size = m => isNumber(m.ratio) && m.ratio > 0 ? Math.abs(Math.log(m.ratio)) : Infinity;
  all.sort((a, b) => b.m.at - a.m.at || rank(a.m) - rank(b.m) || (size(b.m) === size(a.m) ? 0 : size(b.m) - size(a.m)));
  const rows = all.slice(0, ROWS).map(({ c, m }) => {
    const button = el('button', { type: 'button' }, c.name);
    button.addEventListener('click', () => choose(c, m.what));
    const known = m.what === 'status' ? '' : `${figure(m.from)} to ${figure(m.to)}`;
    return [[machine.revisions[m.at].revision, 'key'], [m.verdict + (m.counts ? '' : ' (reference)'), m.verdict],
            [m.what === 'ms' ? 'time in ms' : m.what], [known],
            [isNumber(m.ratio) ? figure(m.ratio) : dash, 'number'],
            [isNumber(m.low) ? `${figure(m.low)} to ${figure(m.high)}` : ''], [button, 'key cell']];
  });
  table($('moves'), ['Revision', 'Moved', 'Figure', 'From, to', 'Ratio', '95 %', 'Cell'], rows);
  $('moves-note').textContent = all.length === 0 ? 'Nothing moved from one revision to the next.'
    : all.length > ROWS ? `The latest ${ROWS} of ${all.length}.` : 'The latest revision first; a cell leads to its chart.';
}

function draw() {
  fillCells();
  fillFigures();
  drawChart();
  drawRevisions();
}

function start() {
  machine = data.machines[Number($('pick-machine').value)];
  cell = null;
  what = 'ms';
  $('filter').value = '';
  const floor = isNumber(machine.floor) ? `${share(machine.floor)}: ${machine.floor_from}`
    : `${share(data.assumed)} assumed, since no run of one program against itself is known of this machine`;
  $('where').textContent = `${machine.revisions.length} revisions, ${machine.cells.length} cells on ${machineName(machine)}. ` +
    `Times that moved less than the machine by itself do not count (${floor}).`;
  cell = machine.cells.length ? machine.cells.reduce((a, b) => latest(b) > latest(a) ? b : a) : null;
  if (cell) {
    const last = cell.moves.filter(m => m.at === latest(cell) && m.what !== 'status').sort((a, b) => rank(a) - rank(b))[0];
    if (last) what = last.what;
    draw();
  }
  drawMoves();
}

Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
$('pick-machine').replaceChildren(...data.machines.map((m, i) => el('option', { value: i }, machineName(m))));
$('pick-machine').addEventListener('change', start);
$('pick-cell').addEventListener('change', () => { cell = machine.cells.find(c => c.key === $('pick-cell').value); draw(); });
$('pick-figure').addEventListener('change', () => { what = $('pick-figure').value; draw(); });
$('filter').addEventListener('input', draw);
dark.addEventListener('change', draw);
start();
