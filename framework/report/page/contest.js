/* Builders and searches on one task: of each result a table, bars of its times, the accuracy of a march, pictures. All text of the figures goes
 * through textContent. */
const page = JSON.parse(document.getElementById('data').textContent);

const theme = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const median = figure => figure && isNumber(figure.median) ? figure.median : NaN;

function brief(value) {
  if (!isNumber(value)) return dash;
  const size = Math.abs(value);
  return size !== 0 && (size < 0.001 || size >= 1e6) ? value.toExponential(1).replace('.0e', 'e').replace('e+', 'e')
                                                     : String(Number(value.toPrecision(3)));
}

/* What differs between the commands. */
const tasks = {
  'bvhbench-volume/1': {
    title: 'Pictures of volumes', answer: 'picture',
    name: r => `${r.scene}, transfer function ${r.transfer}`,
    facts: r => r.tetrahedra ? `${r.tetrahedra} tetrahedra, ${r.boundary_tetrahedra} on the boundary, field “${r.field}”; ${r.pictures} pictures, ${r.pixels} pixels in all.`
      : `${r.voxels.join(' × ')} voxels of ${r.bits} bits; ${r.bricks_seen} of ${r.bricks} bricks seen; ${r.pictures} pictures, ${r.pixels} pixels in all.`,
    columns: [['samples per ray', w => w.samples_per_ray], ['largest difference', w => w.largest_difference]],
    differ: w => w.pixels_that_differ,
  },
};
const task = tasks[page.schema];
const nameOf = way => way.builder ? `${way.builder}, ${way.kernel}` : 'no tree';
const measured = result => result.ways.filter(w => !w.refused);

/* ---- tables ---- */

function ratioText(ratio) {
  if (!ratio || !isNumber(ratio.median)) return '';
  return isNumber(ratio.lo) ? `${brief(ratio.median)} [${brief(ratio.lo)}, ${brief(ratio.hi)}]` : brief(ratio.median);
}

function wayRow(way) {
  const name = el('th', { scope: 'row' }, nameOf(way));
  const number = value => el('td', { class: 'number' }, typeof value === 'string' ? value : brief(value));
  if (way.refused) return el('tr', {}, name, el('td', { colspan: 7 + task.columns.length }, way.refused));
  const wrong = task.differ(way);
  return el('tr', {}, name, number(median(way.build_ms)), number(median(way.layout_ms)), number(median(way[`${task.answer}_ms`])),
            number(ratioText(way[`${task.answer}_ratio`])), number(ratioText(way.all_ratio)), number(way.tree_bytes / 2 ** 20),
            ...task.columns.map(([, value]) => number(value(way))),
            el('td', { class: wrong > 0 ? 'number wrong' : 'number' }, isNumber(wrong) ? String(wrong) : ''));
}

function waysTable(result) {
  const head = ['Way', 'build ms', 'layout ms', `${task.answer} ms`, `${task.answer} / first`, 'all / first', 'tree MiB', ...task.columns.map(c => c[0]), 'differ'];
  return el('div', { class: 'scroll' }, el('table', { class: 'ways' },
    el('thead', {}, el('tr', {}, ...head.map(text => el('th', { scope: 'col' }, text)))), el('tbody', {}, ...result.ways.map(wayRow))));
}

function accuracyTable(result) {
  const head = ['step', 'largest error', 'RMS error', 'samples per ray', 'ms'];
  const row = e => el('tr', {}, ...[e.step, e.most, e.rms, e.samples_per_ray, median(e.picture_ms)].map(v => el('td', { class: 'number' }, brief(v))));
  return el('div', { class: 'scroll' }, el('table', { class: 'accuracy' },
    el('thead', {}, el('tr', {}, ...head.map(text => el('th', { scope: 'col' }, text)))), el('tbody', {}, ...result.accuracy.map(row))));
}

/* ---- charts ---- */

const axisOf = (text, type) => ({
  type, title: { display: true, text, color: theme('--text') }, grid: { color: theme('--line') },
  ticks: { color: theme('--muted'), maxTicksLimit: 8, callback: type === 'logarithmic' ? v => brief(v) : undefined },
});

function card(id, title, note) {
  return el('figure', { class: 'card' }, el('h3', {}, title), el('div', { class: 'plot' }, el('canvas', { id, role: 'img', 'aria-label': title })),
            note ? el('figcaption', {}, note) : null);
}

const parts = [['build', '#4e79a7', w => median(w.build_ms) || 0], ['layout', '#f28e2b', w => median(w.layout_ms) || 0]];

function drawTimes(id, result) {
  const ways = measured(result);
  const datasets = [...parts, [task.answer, '#59a14f', w => median(w[`${task.answer}_ms`]) || 0]].map(([label, colour, value]) =>
    ({ label, data: ways.map(value), backgroundColor: colour }));
  new Chart($(id), {
    type: 'bar', data: { labels: ways.map(nameOf), datasets },
    options: {
      indexAxis: 'y', animation: false, responsive: true, maintainAspectRatio: false,
      scales: { x: { ...axisOf('ms', 'linear'), stacked: true },
                y: { stacked: true, grid: { display: false }, ticks: { color: theme('--muted'), autoSkip: false } } },
      plugins: { legend: { labels: { color: theme('--text') } } },
    },
  });
}

function drawErrors(id, result, title, x) {
  const datasets = [['largest', '#e15759', e => e.most], ['RMS', '#4e79a7', e => e.rms]].map(([label, colour, value]) => ({
    label, showLine: true, borderColor: colour, backgroundColor: colour, borderWidth: 1.5, pointRadius: 3,
    data: result.accuracy.map(e => ({ x: x(e), y: value(e) })).filter(p => p.x > 0 && p.y > 0),
  }));
  new Chart($(id), {
    type: 'scatter', data: { datasets },
    options: {
      animation: false, responsive: true, maintainAspectRatio: false,
      scales: { x: axisOf(title, 'logarithmic'), y: axisOf('error of a channel', 'logarithmic') },
      plugins: { legend: { labels: { color: theme('--text') } } },
    },
  });
}

/* ---- the page ---- */

function pictures(result) {
  const files = result.picture_files || [], sources = result.sources || [];
  const shown = files.map((name, i) => sources[i] && el('figure', {}, el('img', { src: sources[i], alt: name }), el('figcaption', {}, name)));
  const others = files.filter((name, i) => !sources[i]);
  if (files.length === 0) return null;
  return el('div', {}, el('div', { class: 'pictures' }, ...shown.filter(Boolean)),
            others.length > 0 ? el('p', { class: 'note' }, `Not on this page, in its folder: ${others.join(', ')}.`) : null);
}

function show(result, number) {
  const accurate = (result.accuracy || []).length > 0, unit = result.tetrahedra ? '1/128 of the longest side' : 'voxels';
  $('results').append(el('section', { 'aria-labelledby': `result-${number}` },
    el('h2', { id: `result-${number}` }, task.name(result)), el('p', {}, task.facts(result)), waysTable(result),
    el('p', { class: 'note' }, `Medians; / first: of the times with those of the first way, paired round by round, with 95 % intervals; ` +
      'all: with build and layout. differ: how many answers are not the same to the last bit.'),
    el('div', { class: 'charts' }, card(`times-${number}`, 'Time'),
      accurate ? card(`steps-${number}`, 'Step against error', `From a march with ${brief(result.accuracy.at(-1).step / 8)}, which is converged to ${brief(result.converged_to)}.`) : null,
      accurate ? card(`speed-${number}`, 'Time against error', 'The last picture, by the first builder.') : null),
    accurate ? accuracyTable(result) : null, pictures(result)));
  $(`times-${number}`).parentElement.style.height = `${4 + 2 * measured(result).length}rem`;
  drawTimes(`times-${number}`, result);
  if (!accurate) return;
  drawErrors(`steps-${number}`, result, `distance of samples, ${unit}`, e => e.step);
  drawErrors(`speed-${number}`, result, 'ms', e => median(e.picture_ms));
}

function start() {
  const wrong = page.results.flatMap(r => r.ways).reduce((sum, w) => sum + (task.differ(w) || 0), 0);
  $('title').textContent = `bvhbench: ${task.title.toLowerCase()}`;
  document.title = $('title').textContent;
  $('where').textContent = `${page.revision}, ${page.device}`;
  $('verdict').append(wrong === 0 ? 'All answers are the same to the last bit.' : el('b', { class: 'bad' }, `${wrong} answers differ from those of the first way.`));
  page.results.forEach(show);
}
start();
