/* The first screen: what the result says of its builders, over all scenes and rays or a choice of them. Rows, ties and sentences
 * were computed with the results (framework/compare/summary.h); this shows them. */
const chosen = { scene: '', rays: '' };
const summaryOf = (scene, rays) => summaries.choices.find(s => s.scene === scene && s.rays === rays);
const everything = summaryOf('', '') || { rows: [], sentences: [], accuracy: [], scenes: 0, sets: 0, rounds: 0 };
const nameOf = row => merged ? `${row.builder} (${runName(row.run)})` : row.builder;
/* Long names break between their parameters. */
const breakable = name => name.split(/(?<=[:,+])/).flatMap(part => [part, el('wbr')]);
const coloured = unique(everything.rows.filter(r => !r.reference).map(row => seriesOf(nameOf(row))));
const rowColour = row => row.reference ? theme().muted
  : colourAt(coloured.indexOf(seriesOf(nameOf(row))));

/* 0.97, 12.3, 154: as on the terminal. */
const ratio = value => isNumber(value) ? value.toFixed(value < 9.995 ? 2 : value < 99.95 ? 1 : 0) : dash;
const withBounds = s => isNumber(s.low) && isNumber(s.high) ? `95 %: ${ratio(s.low)} to ${ratio(s.high)}` : null;
const standingText = s => `${ratio(s.value)}${s.best ? ' best' : s.tied ? ' \u2248 best' : ''}`;

/* ---- bars ---- */

/* A bar of `share` of the cell's width, with its figure; `heading` stands before it where there is no room for columns. */
function barCell(heading, standing, share, row, extra) {
  const bar = el('i', { class: 'bar', 'aria-hidden': 'true' });
  bar.style.width = `${100 * Math.max(0, Math.min(1, share || 0))}%`;
  bar.style.background = rowColour(row);
  const css = ['bars', standing.best && 'best', extra].filter(Boolean).join(' ');
  return el('td', { class: css, title: withBounds(standing), 'data-heading': heading },
            el('span', { class: 'value' }, standingText(standing)), el('span', { class: 'track' }, bar));
}

/* Build speeds differ by powers of ten: their bars are logarithmic, from a tenth of the slowest. */
function logShare(value, all) {
  const seen = all.filter(v => v > 0), low = Math.min(...seen) / 2, high = Math.max(...seen);
  return value > 0 ? Math.log(value / low) / Math.log(high / low) : 0;
}

/* How the rows of a group that can't be told apart begin and end. */
function tieClass(rows, i) {
  const same = j => rows[j] && isNumber(rows[i].group) && rows[j].group === rows[i].group && !rows[j].reference;
  return same(i - 1) || same(i + 1) ? `tie${same(i - 1) ? '' : ' first'}${same(i + 1) ? '' : ' last'}` : '';
}

/* Links to the papers of a builder, or of each stage of one. */
const paperLinks = builder => builder.split('+').flatMap(stage => papersOf[stage.split(':')[0]] || [])
  .flatMap(paper => [' ', el('a', { class: 'note', href: `https://doi.org/${encodeURI(paper.doi)}`, title: paper.title, rel: 'noreferrer' }, 'paper')]);

function builderCell(summary, row) {
  const note = words => el('span', { class: 'note' }, words);
  return el('th', { scope: 'row' }, ...breakable(nameOf(row)), ...paperLinks(row.builder), row.reference ? note('\u00a0tracer') : null,
    row.partial && !row.reference ? note(` no rank: ${row.sets} of ${plural(summary.sets, 'ray set')}`) : null,
    row.leaves_out ? note(` build not ranked: ${ratio(row.untimed)}x its time is not clocked`) : null);
}

/* The traces that the choice is about; and of these the ones that rank: with `exact` on rays that most builders traced. */
const chosenTraces = () => traces.filter(t => (!chosen.scene || t.scene === chosen.scene) && (!chosen.rays || t.rays === chosen.rays));
const rankingTraces = summary => chosenTraces().filter(t => t.status === 'ok' && (t.reference || t.intersector === 'exact') &&
  2 * (summaryOf(t.scene, t.rays) || everything).rows.length >= summary.rows.length);
const choiceText = () => [chosen.scene || 'all scenes', chosen.rays || 'all rays'].join(' ');
function rowAgain(summary, row) {
  const own = x => x.builder === row.builder && runOf(x) === row.run, traced = rankingTraces(summary).filter(own);
  return traced.length ? tracesCommand(traced) : buildsCommand(builds.filter(own));
}

const wrongRays = row => !(row.checked > 0) ? dash : row.wrong === 0 ? 'none' : `${whole(row.wrong)} of ${brief(row.checked)}`;

/* A column of bars, which `share(value, all values)` of the width are long. */
function barColumn(rows, name, title, get, share, down, extra) {
  const all = rows.map(row => get(row).value).filter(isNumber);
  return { name, title, number: true, down, value: row => get(row).value, text: row => standingText(get(row)),
           node: row => barCell(name, get(row), isNumber(get(row).value) ? share(get(row).value, all) : 0, row, extra && extra(row)) };
}

/* A column of plain figures. */
const plainColumn = (name, title, get, text, css) => ({ name, title, number: true, down: false, value: get, text,
  node: row => el('td', { class: css ? css(row) : null, 'data-heading': name }, text(row)) });

const verdictState = { column: -1, down: false, words: [], odd: false };
function drawBars(summary) {
  const { rows } = summary, most = (value, all) => value / Math.max(...all), least = (value, all) => Math.min(...all) / value;
  const time = (k, rays) => barColumn(rows, `Time for ${rays} rays / best`,
    'build, layout and rays, by the best builder: 1.00 is best; longer bars are faster', row => row.image[k], least, false);
  const sah = schema.metrics.find(m => m.of_layouts).title;
  $('verdict-bars').replaceChildren();
  addTable($('verdict-bars'), 'Builders, the fastest trace first, then other tracers in italics; only a builder can be “best”. Longer bars are better. Press a heading to sort.', [
    { name: 'Builder', value: nameOf, text: nameOf, node: row => builderCell(summary, row) },
    barColumn(rows, `Trace speed / ${summary.reference || 'best'}`,
              'geometric mean over the ray sets; a line at the left: this run cannot tell them apart', row => row.trace, most, true,
              row => tieClass(rows, rows.indexOf(row))),
    barColumn(rows, 'Build, Mprims/s', 'geometric mean over the scenes; bars are logarithmic', row => row.build, logShare, true),
    barColumn(rows, '+ layout, Mprims/s', 'build and layout of the kernel that is fastest most often: what the first ray waits for; bars are logarithmic',
              row => row.ready, logShare, true),
    time(1, '1 M'), time(4, '1 G'),
    plainColumn(`${sah} / best`, 'expected cost of random rays through the tree, by the least', row => row.quality.value,
                row => standingText(row.quality), row => row.quality.best ? 'best' : null),
    plainColumn('Tree', 'bytes of the tree, in the scene where it takes most', row => row.tree, row => bytes(row.tree)),
    plainColumn('Peak', 'bytes of the tree and all scratch memory, in the scene where they are most', row => row.peak, row => bytes(row.peak)),
    plainColumn('Wrong rays', 'of the rays that were judged', row => row.checked > 0 ? row.wrong : null, wrongRays,
                row => row.wrong > 0 ? 'wrong' : null),
    commandColumn(row => rowAgain(summary, row)),
  ], rows, { state: verdictState, css: row => row.reference ? 'reference' : null, name: 'verdict-table' });
}

/* ---- what accuracy costs: intersectors on the same rays, trees and kernels ---- */
function drawIntersectors(summary) {
  const found = summary.accuracy.filter(a => isNumber(a.ppm) && isNumber(a.speed));
  $('verdict-accuracy').hidden = found.length < 2;
  if (found.length < 2) return;
  const points = found.map(a => ({ x: a.ppm, y: a.speed, a, none: a.wrong === 0, atMost: a.wrong === 0, xLow: a.ppm_lo, xHigh: a.ppm_hi,
    key: a.intersector + (a.wrong === 0 ? ': none found' : a.wrong_t > 0.9 * a.wrong ? ' (distances)' : '') }));
  const t = theme(), ours = chosenTraces().filter(row => !row.reference);
  const used = ours.filter(row => ours.some(other => raysKey(other) === raysKey(row) && other.intersector !== row.intersector));
  draw('chart-intersectors', 'Speed of intersectors against wrong rays per million',
       [{ label: 'intersectors', data: points, borderColor: t.muted, pointBorderColor: t.text, pointBorderWidth: 2, pointRadius: 5, clip: 10,
          pointBackgroundColor: points.map(p => p.none ? t.page : t.text) }],
       { x: wrongAxis(wrongRange(points)), y: axis('speed / speed of exact', false, { grace: '20%' }) },
       p => [p.key, `${ratio(p.y)} of the speed of exact`, `${whole(p.a.wrong)} wrong of ${whole(p.a.checked)} rays`],
       { of: choiceText(), command: tracesCommand(used) });
}

/* ---- time to image, by the best ---- */

/* Curves around 1, the best builder, up to 2; above, they leave the picture. Tracers may be below. */
function drawCurves(summary) {
  const counts = summaries.curve_counts, own = summary.rows.filter(r => r.curve.some(isNumber));
  const curves = own.map(row => line(nameOf(row), counts.map((n, i) => ({ x: n, y: row.curve[i] })).filter(p => isNumber(p.y)),
    { own: rowColour(row), width: row.reference ? 1.5 : 2, borderDash: row.reference ? [3, 3] : isOld(nameOf(row)) ? [8, 4] : [], hasTip: true, pointHitRadius: 6, clip: 2 }));
  const short = shortNames(own.map(nameOf));
  for (const { label, data } of curves) { /* its name stands where it is best */
    const best = data.reduce((a, b) => b.y < a.y ? b : a);
    best.key = short.get(label);
    best.front = best.y === 1;
  }
  draw('chart-image', 'Time to image by that of the best builder', curves,
       { x: axis('rays to trace (log scale)', true, { min: counts[0], max: counts[counts.length - 1] }),
         y: axis("time to image / best builder's", false, { min: Math.floor(4 * Math.min(1, ...curves.flatMap(c => c.data.map(p => p.y)))) / 4, max: 2 }) },
       p => `${brief(p.x)} rays: ${ratio(p.y)} of the best builder's`, { of: choiceText(), command: tracesCommand(rankingTraces(summary)) });
  $('verdict-legend').replaceChildren(...own.map(row => seriesButton(nameOf(row), rowColour(row))));
}

/* ---- sentences and figures ---- */
function drawSentences(summary) {
  const sentence = s => el('div', {}, el('dt', {}, s.label), el('dd', { class: /^WRONG/.test(s.text) ? 'bad' : null }, s.text));
  $('verdict-sentences').replaceChildren(...summary.sentences.map(sentence));
  const noise = isNumber(summary.noise) ? `; one rate is good to ${(100 * summary.noise).toFixed(0)} %, of the worst tenth to ${(100 * summary.noise_worst).toFixed(0)} %` : '';
  $('verdict-scope').textContent = `${plural(summary.scenes, 'scene')}, ${plural(summary.sets, 'ray set')}, ${plural(summary.rounds, 'round')}: geometric means${noise}` +
    (summary.sets_aside ? `; ${plural(summary.sets_aside, 'ray set')} aside, traced by too few builders` : '') + '.';
}

function drawSummaryTable(summary) {
  const standing = (name, get, title) => ({ name, number: true, value: r => get(r).value, text: r => standingText(get(r)), title });
  $('verdict-table').replaceChildren();
  addTable($('verdict-table'), 'All figures; press a heading to sort.', [
    { name: 'Builder', text: nameOf, wide: true }, { name: 'Kernel', text: r => r.kernel || dash },
    standing(`Trace /${summary.reference || 'best'}`, r => r.trace), num('Mrays/s', r => r.mrays_s),
    standing('Build Mprims/s', r => r.build), standing('+ layout', r => r.ready, 'build and layout of its kernel'),
    ...summaries.counts.map((n, k) => standing(`${brief(n)} rays`, r => r.image[k], 'time to image, by the best')),
    standing(`${schema.metrics.find(m => m.of_layouts).title} /best`, r => r.quality),
    standing('EPO /best', r => r.overlap, 'end-point overlap of the tree'),
    standing('Work /best', r => r.work, 'counted per ray, by the kernel that needs least: 1.2 for each pair of boxes tested, 1 for each primitive'), num('Peak', r => r.peak, null, bytes), num('Wrong', r => r.wrong, 'rays', whole),
    num('Judged', r => r.checked, 'rays', whole), num('Failed', r => r.failed, 'cells and builds', whole), num('Ray sets', r => r.sets, null, whole),
  ], summary.rows, { css: r => r.reference ? 'reference' : null });
}

/* ---- the choice, also in the address ---- */
function drawVerdict() {
  const summary = summaryOf(chosen.scene, chosen.rays) || everything;
  for (const part of [drawSentences, drawBars, drawIntersectors, drawCurves, drawSummaryTable]) part(summary);
}

function writeAddress() {
  const words = new URLSearchParams([['scene', chosen.scene], ['rays', chosen.rays], ['chart-scene', picked.scene],
    ['chart-rays', picked.rays], ['chart-view', picked.view]].filter(([, value]) => value !== ''));
  history.replaceState(null, '', `#choice:${words}`);
}

function readAddress() {
  if (!location.hash.startsWith('#choice:')) return;
  const words = new URLSearchParams(location.hash.slice('#choice:'.length));
  for (const key of ['scene', 'rays']) {
    chosen[key] = words.get(key) ?? '';
    picked[key] = words.get(`chart-${key}`) ?? '';
  }
  picked.view = words.get('chart-view') ?? '';
  if (!summaryOf(chosen.scene, chosen.rays)) Object.assign(chosen, { scene: '', rays: '' });
}

function startVerdict() {
  const warnings = [summaries.busy && `The times are not to be trusted: ${summaries.busy}.`,
    summaries.implausible && `${summaries.implausible}.`,
    [data.context, ...(data.merged || [])].some(run => run.interrupted) &&
      'The run was interrupted: not all that was asked for was measured.'].filter(Boolean);
  $('verdict-warnings').replaceChildren(...warnings.map(text => el('p', { class: 'warning' }, text)));
  for (const [id, key] of [['verdict-scene', 'scene'], ['verdict-rays', 'rays']]) {
    const values = unique(summaries.choices.map(s => s[key]));
    $(id).replaceChildren(...values.map(v => el('option', { value: v }, v || `all ${key === 'scene' ? 'scenes' : 'rays'}`)));
    $(id).value = chosen[key];
    $(id).addEventListener('change', event => {
      const before = chosen[key];
      chosen[key] = event.target.value;
      if (!summaryOf(chosen.scene, chosen.rays)) chosen[key] = event.target.value = before; /* nothing was measured of that */
      drawVerdict();
      writeAddress();
    });
  }
  drawVerdict();
}
