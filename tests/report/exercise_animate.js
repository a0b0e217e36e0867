/* Looks through the page of moving scenes: each method has its row and its curves, all finite, and winners are named where their curves are lowest, in
 * the time that the table says. What it found stands in an element of its own. */
(() => {
const findings = [];
const expect = (ok, what) => { if (!ok) findings.push(what); };
const rows = JSON.parse($('table').textContent).rows, distinct = list => [...new Set(list)];
const scenes = distinct(rows.map(row => row.scene).filter(Boolean)), frames = distinct(rows.filter(row => row.primitives && row.frame).map(row => row.frame));
const methods = distinct(rows.map(row => row.builder).filter(Boolean)), kernels = distinct(rows.map(row => row.intersector).filter(Boolean));
const kinds = distinct(rows.filter(row => row.rays !== undefined).map(row => row.question)), winners = rows.filter(row => row.fastest);
const entries = caption => [...document.querySelectorAll('table')].filter(table => table.caption.textContent.startsWith(caption))
  .flatMap(table => [...table.querySelectorAll('tbody tr')]).map(row => [...row.children].map(entry => entry.textContent));

expect(document.querySelector('#results .summary').textContent === 'All answers in all frames are right.', 'the verdict');
expect(document.title === 'bvhbench: moving scenes' && document.querySelectorAll('h2').length === scenes.length && scenes.length === 1, document.title);
expect(!/NaN|undefined|null/.test($('results').innerText), 'a figure that is none');

const named = entries('Methods');
expect(methods.length > 3 && named.length === methods.length && named.every((line, i) => line[0] === methods[i]), 'a row for each method');
expect(kernels.length === 2 && entries('Kernels').length === methods.length * kernels.length, 'a row for each method and kernel');
const others = methods.filter(method => method !== rows.find(row => row.faster_than).faster_than), faster = entries('Rays per frame');
expect(faster.length === others.length && faster.every(line => line.length === 1 + kinds.length), 'a row for each other method');
expect(faster.every(line => line.slice(1).every(text => /^(any number|none|(below |above |and |to |[0-9.,e+]+ ?)+)$/.test(text))), 'faster');
expect(entries('Who is fastest').length === winners.length && winners.length === 5 * kinds.length, `${winners.length} winners`);
expect(frames.length === 5 && entries('Frames').length === 5 && entries('Updates').length === 5 && entries('SAH / fresh').length === 5, 'a row for each frame');
const strip = document.querySelector('.pictures img');
expect(strip !== null && strip.naturalWidth > strip.naturalHeight * 2 && strip.width > 500, 'a strip of pictures');

const charts = Object.fromEntries([...document.querySelectorAll('canvas')].map(canvas => [canvas.getAttribute('aria-label'), Chart.getChart(canvas)]));
const names = ['Updates', 'Costs', ...kinds.map(kind => `Time of a frame, ${kind}`)], colours = new Set();
expect(Object.keys(charts).sort().join() === names.sort().join(), Object.keys(charts).join());
for (const [name, chart] of Object.entries(charts)) {
  expect(chart.data.datasets.map(set => set.label).join() === methods.join(), `${name}: a curve for each method`);
  for (const { label, data, borderColor, borderDash } of chart.data.datasets) {
    expect(data.length > 1 && data.every(p => Number.isFinite(p.x) && p.y > 0), `${name}: ${label}`);
    colours.add(`${label} ${borderColor} ${borderDash}`);
  }
}
expect(colours.size === methods.length, 'a method has one colour in all charts');
const build = charts.Updates.data.datasets[0].data.map(p => p.x).join();
expect(build === frames.slice(1).join(), `updates of frames ${build}`); /* the first is a build for all */

for (const { question, frame, fastest, least_frame_ms } of winners) {
  const at = charts[`Time of a frame, ${question}`].data.datasets.map(set => ({ label: set.label, y: (set.data.find(p => p.x === parseFloat(frame)) || {}).y }));
  const lowest = at.filter(p => p.y > 0).reduce((a, b) => (b.y < a.y ? b : a), { y: Infinity });
  expect(lowest.y === least_frame_ms && fastest.startsWith(`${lowest.label}, `), `${frame}, ${question}: ${lowest.label} in ${lowest.y} ms, not ${fastest}`);
}
const said = findings.length ? findings.join('; ') : `${names.length} charts, all well`;
document.body.append(Object.assign(document.createElement('p'), { textContent: `EXERCISE: ${said}` }));
})();
