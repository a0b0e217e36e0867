/* Methods on scenes that move: of each scene a table, updates and costs over the frames, and who is fastest for how many rays per frame. All
 * text of the figures goes through textContent. */
const page = JSON.parse(document.getElementById('data').textContent);

const theme = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const palette = ['#4e79a7', '#e15759', '#59a14f', '#f28e2b', '#b07aa1', '#76b7b2', '#9c755f', '#edc948', '#ff9da7', '#86868b'];
const dashes = [[], [6, 3], [2, 2]];
const ways = ['kept', 'updated', 'rebuilt'];

function brief(value) {
  if (!isNumber(value)) return dash;
  const size = Math.abs(value);
  return size !== 0 && (size < 0.001 || size >= 1e6) ? value.toExponential(1).replace('.0e', 'e').replace('e+', 'e') : String(Number(value.toPrecision(3)));
}

const rest = list => list.slice(1).filter(isNumber); /* the first frame is a build for all */
const sum = list => list.reduce((a, b) => a + b, 0);
const mean = list => list.length ? sum(list) / list.length : NaN;
const complete = result => result.methods.filter(m => !m.refused);

/* Mean time of a frame with `count` rays of a kind, by the method's best kernel. */
function frameTime(result, method, rays, count) {
  const before = mean(rest(method.update_ms)) + mean(rest(method.transfer_ms)), traced = sum(rest(result.rays[rays]));
  return Math.min(...method.kernels.map(k => before + mean(rest(k.layout_ms)) + count * sum(rest(k.rays_ms[rays])) / traced));
}

/* ---- tables ---- */

function waysOf(method) {
  const counts = ways.map((word, way) => [method.way.slice(1).filter(w => w === way).length, word]);
  return counts.filter(([count]) => count > 0).map(([count, word]) => `${count} ${word}`).join(', ');
}

function methodRow(result, method) {
  const number = value => el('td', { class: 'number' }, typeof value === 'string' ? value : brief(value));
  const name = el('th', { scope: 'row' }, method.method);
  const kinds = Object.keys(result.rays);
  if (method.update_ms.length < 2) return el('tr', {}, name, el('td', { colspan: 10 + kinds.length }, method.refused || ''));
  const rate = rays => Math.max(...method.kernels.map(k => sum(rest(result.rays[rays])) / sum(rest(k.rays_ms[rays])) / 1e3));
  return el('tr', {}, name, number(method.sums.update_ms), number(method.sums.worst_update_ms), number(method.sums.worst_frame),
            number(Math.min(...method.kernels.map(k => mean(rest(k.layout_ms))))), ...kinds.map(rays => number(rate(rays))),
            number(method.sums.sah_over_best), number(method.sums.sah_over_best_most), number(method.sums.drift_per_frame), number(method.most_bytes / 2 ** 20),
            el('td', { class: method.sums.wrong > 0 ? 'number wrong' : 'number' }, String(method.sums.wrong)),
            el('td', {}, waysOf(method) + (method.refused ? `; then ${method.refused}` : '')));
}

function methodsTable(result) {
  const head = ['Method', 'update ms', 'worst', 'in frame', 'layout ms', ...Object.keys(result.rays).map(rays => `${rays}, Mrays/s`), 'SAH / fresh', 'most', 'drift per frame', 'MiB', 'wrong', 'frames'];
  return el('div', { class: 'scroll' }, el('table', { class: 'methods' },
    el('thead', {}, el('tr', {}, ...head.map(text => el('th', { scope: 'col' }, text)))),
    el('tbody', {}, ...result.methods.map(m => methodRow(result, m)))));
}

function winnersTable(result) {
  const counts = [...new Set(result.winners.map(w => w.count))];
  const entry = (rays, count) => result.winners.find(w => w.rays === rays && w.count === count);
  const cell = w => w ? el('td', {}, `${w.method}, ${w.kernel}: ${brief(w.frame_ms)} ms`) : el('td', {}, dash);
  return el('div', { class: 'scroll' }, el('table', { class: 'winners' },
    el('thead', {}, el('tr', {}, el('th', { scope: 'col' }, 'Rays per frame'), ...counts.map(n => el('th', { scope: 'col' }, brief(n))))),
    el('tbody', {}, ...Object.keys(result.rays).map(rays => el('tr', {}, el('th', { scope: 'row' }, rays), ...counts.map(n => cell(entry(rays, n))))))));
}

function interval({ from, to }) {
  if (from === 0) return to === null ? 'any number' : `below ${brief(to)}`;
  return to === null ? `above ${brief(from)}` : `${brief(from)} to ${brief(to)}`;
}

function fasterTable(result) {
  const kinds = Object.keys(result.rays), methods = result.methods.filter(m => Object.keys(m.faster).length > 0);
  if (methods.length === 0) return null;
  const cell = intervals => el('td', {}, intervals.length > 0 ? intervals.map(interval).join(' and ') : 'none');
  return el('div', { class: 'scroll' }, el('table', { class: 'faster' },
    el('thead', {}, el('tr', {}, ...[`Rays per frame, faster than ${result.faster_than}`, ...kinds].map(text => el('th', { scope: 'col' }, text)))),
    el('tbody', {}, ...methods.map(m => el('tr', {}, el('th', { scope: 'row' }, m.method), ...kinds.map(rays => cell(m.faster[rays])))))));
}

/* ---- charts ---- */

function card(id, title, note) {
  return el('figure', { class: 'card' }, el('h3', {}, title), el('div', { class: 'plot' }, el('canvas', { id, role: 'img', 'aria-label': title })),
            note ? el('figcaption', {}, note) : null);
}

const axisOf = (text, type) => ({
  type, title: { display: true, text, color: theme('--text') }, grid: { color: theme('--line') },
  ticks: { color: theme('--muted'), maxTicksLimit: 8, callback: type === 'logarithmic' ? v => brief(v) : undefined },
});

/* A curve per method: `points(method)` gives x and y. */
function draw(id, methods, all, points, x, y) {
  const datasets = methods.map(method => {
    const number = all.indexOf(method), colour = palette[number % palette.length];
    return { label: method.method, showLine: true, borderColor: colour, backgroundColor: colour, borderWidth: 1.5, pointRadius: 1.5,
             borderDash: dashes[Math.floor(number / palette.length) % dashes.length], data: points(method).filter(p => isNumber(p.y) && p.y > 0) };
  });
  new Chart($(id), {
    type: 'scatter', data: { datasets },
    options: { animation: false, responsive: true, maintainAspectRatio: false, scales: { x, y },
               plugins: { legend: { labels: { color: theme('--text'), boxWidth: 12 } } } },
  });
}

function drawAll(result, number) {
  const all = result.methods, overFrames = of => method => of(method).map((y, f) => ({ x: result.frames[f], y })).slice(1);
  draw(`update-${number}`, all, all, overFrames(m => m.update_ms), axisOf('frame', 'linear'), axisOf('update, ms', 'logarithmic'));
  draw(`cost-${number}`, all, all, overFrames(m => m.sah.map((sah, f) => sah / result.sah_fresh_best[f])), axisOf('frame', 'linear'), axisOf('SAH / fresh', 'logarithmic'));
  Object.keys(result.rays).forEach((rays, k) => {
    const counts = Array.from({ length: 17 }, (_, i) => 10 ** (5 + i / 4));
    draw(`wins-${number}-${k}`, complete(result), all, m => counts.map(x => ({ x, y: frameTime(result, m, rays, x) })),
         axisOf(`rays per frame, ${rays}`, 'logarithmic'), axisOf('time of a frame, ms', 'logarithmic'));
  });
}

/* ---- the page ---- */

function pictures(result) {
  const files = result.picture_files || [], sources = result.sources || [];
  const shown = files.map((name, i) => sources[i] && el('figure', {}, el('img', { src: sources[i], alt: name }), el('figcaption', {}, name)));
  return files.length > 0 ? el('div', { class: 'pictures strip' }, ...shown.filter(Boolean)) : null;
}

function show(result, number) {
  const kinds = Object.keys(result.rays);
  $('results').append(el('section', { 'aria-labelledby': `result-${number}` },
    el('h2', { id: `result-${number}` }, result.scene),
    el('p', {}, `Frames ${result.frames[0]} to ${result.frames.at(-1)}, ${result.primitives[0]} primitives at first, view ${result.view}; ${result.rounds} rounds.`),
    pictures(result), methodsTable(result),
    el('p', { class: 'note' }, 'Means over the frames behind the first, which is a build for all, of medians over the rounds. Layout and rates are those of the best kernel.'),
    el('h3', {}, 'Who is fastest'), winnersTable(result), fasterTable(result),
    el('div', { class: 'charts' }, card(`update-${number}`, 'Updates'),
      card(`cost-${number}`, 'Cost', `Surface area heuristic of the tree, over that of the best tree made for the same frame (${Object.keys(result.sah_fresh).join(', ')}).`),
      ...kinds.map((rays, k) => card(`wins-${number}-${k}`, `Time of a frame, ${rays}`, 'Update, layout and tracing by the best kernel.')))));
  drawAll(result, number);
}

function start() {
  const wrong = sum(page.results.flatMap(r => r.methods).map(m => m.sums.wrong));
  document.title = $('title').textContent = 'bvhbench: moving scenes';
  $('where').textContent = `${page.revision}, ${page.device}`;
  $('verdict').append(wrong === 0 ? 'All answers in all frames are right.' : el('b', { class: 'bad' }, `${wrong} answers are wrong.`));
  page.results.forEach(show);
}
start();
