/* Looks through the page that test_page writes: numbers are the same text as in C, tables sort, charts have their points. What it found stands in an
 * element of its own. */
(() => {
const findings = [];
const expect = (ok, what) => { if (!ok) findings.push(what); };
const tables = [...document.querySelectorAll('table')];
const rowsOf = table => [...table.querySelectorAll('tbody tr')].map(row => [...row.children].map(entry => entry.textContent));

expect(document.title === 'bvhbench: a title' && $('title').textContent === document.title, document.title);
expect(document.querySelector('.warning').textContent === '2 answers differ.', 'a verdict that is bad');
expect(JSON.parse($('table').textContent).command === 'slice', 'the table is in the page');
expect(document.querySelector('.pictures').textContent === 'A picture: not on this page, in its folder: none.png', 'a picture that is missing');
expect(rowsOf(tables[0])[0][0] === '<\/script><b>|`*x*\u001b[31m%FF', 'a hostile name is text');
expect(tables[0].querySelectorAll('.best').length === 1, 'the best are marked');

const figures = rowsOf(tables.find(table => table.caption.firstChild.textContent === 'Figures'));
expect(figures.length > 30, `${figures.length} figures`);
for (const [c, ...page] of figures) expect(`${page.join(';')};` === c, `${page.join(';')}; in C ${c}`);

const ways = tables.find(table => table.caption.firstChild.textContent === 'Ways');
const heading = [...ways.querySelectorAll('th button')].find(button => button.textContent === 'answer ms');
const builders = () => rowsOf(ways).map(row => row[0]).join();
expect(builders() === 'lbvh,sah', builders());
heading.click();
expect(builders() === 'lbvh,sah' && heading.parentElement.getAttribute('aria-sort') === 'ascending', `up: ${builders()}`);
heading.click();
expect(builders() === 'sah,lbvh' && heading.parentElement.getAttribute('aria-sort') === 'descending', `down: ${builders()}`);

const alignment = entry => getComputedStyle(entry).textAlign;
expect(alignment(heading.parentElement) === alignment(ways.querySelector('td.number')), 'a heading stands above its numbers');

const charts = [...document.querySelectorAll('canvas')].map(canvas => Chart.getChart(canvas));
expect(charts.length === 2 && charts[0].data.labels.join() === 'b' && charts[0].data.datasets[0].data.join() === '3', 'bars');
expect(charts[1].data.datasets.length === 1 && charts[1].data.datasets[0].data.map(p => p.x * 100 + p.y).join() === '101,204,309,416', 'lines');
findings.push(...exerciseFiles(['<\/script><b>|`*x*', 'answer ms']));
const said = findings.length ? findings.join('; ') : `${charts.length} charts, all well`;
document.body.append(Object.assign(document.createElement('p'), { textContent: `EXERCISE: ${said}` }));
})();
