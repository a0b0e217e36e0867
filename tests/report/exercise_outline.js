/* Looks through the page of a contest's table: each way has its row and its bar, the best are marked, each picture is shown. What it found stands in an
 * element of its own. */
(() => {
const findings = [];
const expect = (ok, what) => { if (!ok) findings.push(what); };
const rows = JSON.parse($('table').textContent).rows, ways = rows.filter(row => row.intersector), ran = ways.filter(row => !row.refused);
const scenes = [...new Set(rows.map(row => row.scene).filter(Boolean))];
const tables = [...document.querySelectorAll('table')].filter(table => table.caption.textContent === 'Ways');

expect(document.querySelector('#results .summary').textContent === 'All answers are the same to the last bit.', 'the verdict');
expect($('title').textContent === document.title && document.title !== 'bvhbench', document.title);
expect(document.querySelectorAll('h2').length === scenes.length && tables.length === scenes.length && scenes.length > 0, `${scenes.length} scenes`);
expect(ways.some(way => way.refused), 'lbvh has no octree, which a row says');

const lines = tables.flatMap(table => [...table.querySelectorAll('tbody tr')]).map(row => [...row.children].map(entry => entry.textContent));
expect(lines.length === ways.length, `a row for each of ${ways.length} ways`);
lines.forEach((line, i) => {
  expect(line.includes(ways[i].builder || '') && line.includes(ways[i].intersector), `the name of way ${i}`);
  expect(line.at(-1) === (ways[i].refused || '') && line.every(text => !/NaN|undefined|null/.test(text)), line.join(' | '));
});
expect(tables.every(table => table.querySelector('.best')), 'the best are marked');

const charts = [...document.querySelectorAll('canvas')].map(canvas => Chart.getChart(canvas));
expect(charts.length === scenes.length, `${charts.length} charts`);
expect(charts.reduce((sum, chart) => sum + chart.data.labels.length, 0) === ran.length, 'a bar for each way that ran');
expect(charts.every(chart => chart.data.datasets.length === 3 && chart.data.datasets[2].data.every(v => v > 0)), 'each answer took time');
const pictures = [...document.querySelectorAll('img')];
expect(pictures.length === rows.filter(row => row.picture).length && pictures.length > 0, `${pictures.length} pictures`);
expect(pictures.every(img => img.naturalWidth > 0 && img.alt !== ''), 'pictures are shown');
const said = findings.length ? findings.join('; ') : `${charts.length} charts, all well`;
document.body.append(Object.assign(document.createElement('p'), { textContent: `EXERCISE: ${said}` }));
})();
