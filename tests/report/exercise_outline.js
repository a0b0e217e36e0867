/* Looks through the page of a contest's table: each way has its row and its bar, each step of a march its row and its points, the best are marked, each
 * picture is shown. What it found stands in an element of its own. */
(() => {
const findings = [];
const expect = (ok, what) => { if (!ok) findings.push(what); };
const rows = JSON.parse($('table').textContent).rows, ways = rows.filter(row => row.intersector), ran = ways.filter(row => !row.refused);
const scenes = [...new Set(rows.map(row => row.scene).filter(Boolean))];
const captioned = text => [...document.querySelectorAll('table')].filter(table => table.caption.firstChild.textContent === text);
const entries = tables => tables.flatMap(table => [...table.querySelectorAll('tbody tr')]).map(row => [...row.children].map(entry => entry.textContent));
const tables = captioned('Ways'), steps = rows.filter(row => row.rms_error !== undefined), studied = new Set(steps.map(row => row.scene)).size;

expect(document.querySelector('#results .summary').textContent === 'All answers are the same to the last bit.', 'the verdict');
expect($('title').textContent === document.title && document.title !== 'bvhbench', document.title);
expect(document.querySelectorAll('h2').length === scenes.length && tables.length === scenes.length && scenes.length > 0, `${scenes.length} scenes`);
expect(ways.some(way => way.refused), 'lbvh has no octree, which a row says');

const lines = entries(tables);
expect(lines.length === ways.length, `a row for each of ${ways.length} ways`);
lines.forEach((line, i) => {
  expect(line.includes(ways[i].builder || '') && line.includes(ways[i].intersector), `the name of way ${i}`);
  expect(ways[i].refused ? line.at(-1) === ways[i].refused : line.includes('0'), `${line.join(' | ')}: refused, or none differs`);
});
for (const line of [...lines, ...entries(captioned('Accuracy'))]) expect(line.every(text => !/NaN|undefined|null/.test(text)), line.join(' | '));
expect(entries(captioned('Accuracy')).length === steps.length, 'a row for each step');
expect(tables.every(table => table.querySelector('.best')), 'the best are marked');

const charts = [...document.querySelectorAll('canvas')].map(canvas => Chart.getChart(canvas));
const bars = charts.filter(chart => chart.config.type === 'bar'), lined = charts.filter(chart => chart.config.type !== 'bar');
const points = lined.flatMap(chart => chart.data.datasets).flatMap(set => set.data);
expect(bars.length === scenes.length && lined.length === 2 * studied, `${bars.length} + ${lined.length} charts`);
expect(bars.reduce((sum, chart) => sum + chart.data.labels.length, 0) === ran.length, 'a bar for each way that ran');
expect(bars.every(chart => chart.data.labels.every(name => /^[^,]/.test(name))), 'names of bars');
expect(bars.every(chart => chart.data.datasets.length === 3 && chart.data.datasets[2].data.every(v => v > 0)), 'each answer took time');
expect(points.length === 4 * steps.length && points.every(p => p.x > 0 && p.y > 0), `${points.length} points of ${steps.length} steps`);
const pictures = [...document.querySelectorAll('img')];
expect(pictures.length === rows.filter(row => row.picture).length && pictures.length > 0, `${pictures.length} pictures`);
expect(pictures.every(img => img.naturalWidth > 0 && img.alt !== ''), 'pictures are shown');
const said = findings.length ? findings.join('; ') : `${charts.length} charts, all well`;
document.body.append(Object.assign(document.createElement('p'), { textContent: `EXERCISE: ${said}` }));
})();
