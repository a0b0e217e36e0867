/* Methods on scenes that move: of each scene a table, updates and costs over the frames, and who is fastest for how many rays per frame. All
 * text of the figures goes through textContent. */
const page = JSON.parse(document.getElementById('data').textContent);

const palette = ['#4e79a7', '#e15759', '#59a14f', '#f28e2b', '#b07aa1', '#76b7b2', '#9c755f', '#edc948', '#ff9da7', '#86868b'];
const dashes = [[], [6, 3], [2, 2]];
const ways = ['kept', 'updated', 'rebuilt'];

const rest = list => list.slice(1).filter(isNumber); /* the first frame is a build for all */
const sum = list => list.reduce((a, b) => a + b, 0);
const mean = list => list.length ? sum(list) / list.length : NaN;
const isRight = kernel => sum(kernel.wrong) === 0;
const complete = result => result.methods.filter(m => !m.refused && m.kernels.some(isRight));

/* Mean time of a frame with `count` rays of a kind, by the method's best kernel, of those that are right. */
function frameTime(result, method, rays, count) {
  const before = mean(rest(method.update_ms)) + mean(rest(method.transfer_ms)), traced = sum(rest(result.rays[rays]));
  return Math.min(...method.kernels.filter(isRight).map(k => before + mean(rest(k.layout_ms)) + count * sum(rest(k.rays_ms[rays])) / traced));
}

/* ---- tables ---- */

function waysOf(method) {
  const counts = ways.map((word, way) => [method.way.slice(1).filter(w => w === way).length, word]);
  return counts.filter(([count]) => count > 0).map(([count, word]) => `${count} ${word}`).join(', ');
}

const whyNot = method => (method.failed ? 'FAILED: ' : '') + method.refused;

/* A row for each of its kernels; what is the method's own stands beside all of them. */
function methodRows(result, method) {
  const number = (value, rowspan, decimals) => el('td', { class: 'number', rowspan }, figure(value, decimals));
  const kinds = Object.keys(result.rays), sums = method.sums, kernels = method.kernels;
  if (method.update_ms.length < 2)
    return [el('tr', {}, el('th', { scope: 'row' }, method.method), el('td', { colspan: 11 + kinds.length, class: method.failed ? 'wrong' : '' }, whyNot(method)))];
  const n = kernels.length, wrong = sums.wrong > 0 || method.failed ? ' wrong' : '';
  const own = [number(sums.update_ms, n), number(sums.worst_update_ms, n), number(sums.worst_frame, n, 0), number(sums.sah_over_best, n),
               number(sums.sah_over_best_most, n), number(sums.drift_per_frame, n), number(method.most_bytes / 2 ** 20, n)];
  return kernels.map((k, i) => el('tr', {},
    ...(i > 0 ? [] : [el('th', { scope: 'rowgroup', rowspan: n }, method.method), ...own,
                      el('td', { class: `ways${wrong}`, rowspan: n }, waysOf(method) + (method.refused ? `; then ${whyNot(method)}` : ''))]),
    el('td', {}, k.kernel), number(mean(rest(k.layout_ms)), 1), ...kinds.map(rays => number(sum(rest(result.rays[rays])) / sum(rest(k.rays_ms[rays])) / 1e3, 1)),
    el('td', { class: sum(k.wrong) > 0 ? 'number wrong' : 'number' }, String(sum(k.wrong)))));
}

function methodsTable(result) {
  const head = ['Method', 'update ms', 'worst', 'in frame', 'SAH / fresh', 'most', 'drift per frame', 'MiB', 'frames', 'kernel', 'layout ms', ...Object.keys(result.rays).map(rays => `${rays}, Mrays/s`), 'wrong'];
  return el('div', { class: 'scroll' }, el('table', { class: 'methods' },
    el('thead', {}, el('tr', {}, ...head.map(text => el('th', { scope: 'col' }, text)))),
    el('tbody', {}, ...result.methods.flatMap(m => methodRows(result, m)))));
}

function winnersTable(result) {
  const counts = [...new Set(result.winners.map(w => w.count))];
  const entry = (rays, count) => result.winners.find(w => w.rays === rays && w.count === count);
  const others = w => w.as_fast.length > 0 ? `; as fast: ${w.as_fast.join(', ')}` : '';
  const cell = w => w ? el('td', {}, `${w.method}, ${w.kernel}: ${figure(w.frame_ms)} ms${others(w)}`) : el('td', {}, dash);
  return el('div', { class: 'scroll' }, el('table', { class: 'winners' },
    el('thead', {}, el('tr', {}, el('th', { scope: 'col' }, 'Rays per frame'), ...counts.map(n => el('th', { scope: 'col' }, figure(n, 0))))),
    el('tbody', {}, ...Object.keys(result.rays).map(rays => el('tr', {}, el('th', { scope: 'row' }, rays), ...counts.map(n => cell(entry(rays, n))))))));
}

function interval({ from, to }) {
  if (from === 0) return to === null ? 'any number' : `below ${figure(to)}`;
  return to === null ? `above ${figure(from)}` : `${figure(from)} to ${figure(to)}`;
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
               plugins: { legend: { labels: { color: colourOf('--text'), boxWidth: 12 } } } },
  });
}

function drawAll(result, number) {
  const all = result.methods, overFrames = of => method => of(method).map((y, f) => ({ x: result.frames[f], y })).slice(1);
  draw(`update-${number}`, all, all, overFrames(m => m.update_ms), axisOf('frame', false), axisOf('update, ms', true));
  draw(`cost-${number}`, all, all, overFrames(m => m.sah.map((sah, f) => sah / result.sah_fresh_best[f])), axisOf('frame', false), axisOf('SAH / fresh', true));
  Object.keys(result.rays).forEach((rays, k) => {
    const counts = Array.from({ length: 17 }, (_, i) => 10 ** (5 + i / 4));
    draw(`wins-${number}-${k}`, complete(result), all, m => counts.map(x => ({ x, y: frameTime(result, m, rays, x) })),
         axisOf(`rays per frame, ${rays}`, true), axisOf('time of a frame, ms', true));
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
    el('p', {}, `Frames ${result.frames[0]} to ${result.frames.at(-1)}, ${result.primitives[0]} primitives at first, view ${result.view}; ${result.rounds} ${result.rounds === 1 ? 'round' : 'rounds'}.`),
    pictures(result), methodsTable(result),
    el('p', { class: 'note' }, 'Means over the frames behind the first, which is a build for all, of medians over the rounds.'),
    el('h3', {}, 'Who is fastest'), winnersTable(result), fasterTable(result),
    el('p', { class: 'note' }, 'Faster: by more than 5 % in the medians, and in every round. What gives wrong answers is not among the fastest.'),
    el('div', { class: 'charts' }, card(`update-${number}`, 'Updates', 'A tree that is kept takes no time, and has no point.'),
      card(`cost-${number}`, 'Cost', `Surface area heuristic of the tree, over that of the best tree made for the same frame (${Object.keys(result.sah_fresh).join(', ')}).`),
      ...kinds.map((rays, k) => card(`wins-${number}-${k}`, `Time of a frame, ${rays}`, 'Update, layout and tracing by the best kernel.')))));
  drawAll(result, number);
}

function start() {
  const methods = page.results.flatMap(r => r.methods), wrong = sum(methods.map(m => m.sums.wrong)), failed = methods.filter(m => m.failed);
  const faults = [...(wrong > 0 ? [`${wrong} answers are wrong.`] : []), ...failed.map(m => `${m.method} failed: ${m.refused}.`)];
  document.title = $('title').textContent = 'bvhbench: moving scenes';
  $('where').textContent = `${page.revision}, ${page.device}`;
  $('verdict').append(faults.length === 0 ? 'All answers in all frames are right.' : el('b', { class: 'bad' }, faults.join(' ')));
  page.results.forEach(show);
}
start();
