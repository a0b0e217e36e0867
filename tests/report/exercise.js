/* Uses the page as a person would: every choice, every button, sorting, filtering, the keyboard, the print. What it found stands in
 * an element of its own; an error on the way is a console message. */
(async () => {
'use strict';
const $ = id => document.getElementById(id), findings = [];
const expect = (ok, what) => { if (!ok) findings.push(what); };
const change = node => node.dispatchEvent(new Event('change', { bubbles: true }));
const choose = (id, value) => { $(id).value = value; change($(id)); };
const values = id => [...$(id).options].map(option => option.value);
const rows = id => [...$(id).querySelectorAll('tbody tr')];
const ids = ['chart-accuracy', 'chart-builders', 'chart-time', 'chart-quality', 'chart-build'];
const marks = id => Number($(id).getAttribute('aria-label').match(/: ([0-9]+) mark/)[1]);

/* Every scene, rays and view with every choice of trees and metric. */
let choices = 0;
for (const scene of values('pick-scene')) {
  choose('pick-scene', scene);
  for (const rays of values('pick-rays')) {
    choose('pick-rays', rays);
    for (const view of values('pick-view')) {
      choose('pick-view', view);
      for (const tree of values('pick-tree')) {
        choose('pick-tree', tree);
        expect(marks('chart-accuracy') === rows('accuracy-table').length, `${scene} ${rays} ${view} ${tree}: a row per mark`);
        choices++;
      }
      for (const metric of values('pick-metric')) choose('pick-metric', metric);
      for (const cost of values('pick-cost')) {
        choose('pick-cost', cost);
        expect(marks('chart-prediction') > 0, `${rays} ${cost}: no cell`);
      }
      for (const id of ids) expect(marks(id) > 0 || id === 'chart-quality', `${scene} ${rays} ${view}: ${id} is empty`);
    }
  }
}
expect(choices >= 3 * 5 * 7, `only ${choices} choices`);

/* What the upright lines are: of 6 rounds intervals, of 3 a range, of 1 there are none. */
const notes = [['Upright lines at the marks are 95 % intervals'],
               ['Dashed upright lines at the marks are the range'], []];
values('pick-scene').forEach((scene, i) => {
  choose('pick-scene', scene);
  for (const id of ['accuracy-note', 'quality-note', 'build-note'])
    for (const words of notes.flat())
      expect($(id).textContent.includes(words) === notes[i].includes(words),
             `${scene} ${id}: '${words}'`);
  const marked = Chart.getChart('chart-accuracy').data.datasets.filter(set => !set.isLine);
  const spreads = marked.flatMap(set => set.data).map(p => p.ySpread);
  expect(spreads.every(s => i === 2 ? !s : s.isInterval === (i === 0)), `${scene}: other lines`);
});
choose('pick-scene', values('pick-scene')[0]);

/* A hidden series takes its marks with it, and comes back. */
choose('pick-tree', '*');
for (const button of document.querySelectorAll('#legend-kernels button, #legend-builders button')) {
  const before = marks('chart-accuracy');
  button.click();
  const pressed = () => button.getAttribute('aria-pressed');
  expect(pressed() === 'false' && marks('chart-accuracy') < before, `${button.textContent} hides nothing`);
  button.click();
  expect(pressed() === 'true' && marks('chart-accuracy') === before, `${button.textContent} does not come back`);
}
const buttons = [...document.querySelectorAll('#legend-kernels button, #legend-builders button')];
for (const button of buttons) button.click();
expect(marks('chart-accuracy') === 0, 'marks without a series');
for (const button of buttons) button.click();

/* Names stand beside the marks. */
expect(Chart.getChart('chart-builders').data.datasets.flatMap(set => set.data).every(p => !p.key || /[a-z]/.test(p.key)), 'marks without names');

/* Sorting puts figures in order, both ways, in every column of the first table and by speed beside a chart; what is not measured
 * stays last; the headings are buttons, which the keyboard reaches and presses. */
const figureOf = text => text === 'none' ? 0 : text === '-' ? NaN
  : Number(text.replace(/[,\u2264]/g, '').match(/[0-9.]+/)[0]) * ({ KiB: 2 ** 10, MiB: 2 ** 20, GiB: 2 ** 30 }[text.match(/[KMG]iB/)?.[0]] ?? 1);
function sorts(id, heading) {
  const column = [...heading.closest('tr').children].indexOf(heading.parentNode), seen = new Set();
  expect(heading.tagName === 'BUTTON' && heading.tabIndex === 0, `${heading.textContent}: the keyboard does not reach it`);
  for (let press = 0; press < 2; press++) {
    heading.click();
    const direction = heading.parentNode.getAttribute('aria-sort'), sign = direction === 'ascending' ? 1 : -1;
    const figures = rows(id).map(row => figureOf(row.children[column].textContent)), measured = figures.filter(Number.isFinite);
    seen.add(direction);
    expect(measured.length > 1 && figures.slice(0, measured.length).every(Number.isFinite), `${heading.textContent}: ${figures}`);
    expect(measured.every((v, i) => i === 0 || sign * (v - measured[i - 1]) >= 0), `${heading.textContent} ${direction}: ${measured}`);
  }
  expect(seen.has('ascending') && seen.has('descending'), `${heading.textContent} sorts ${[...seen]}`);
}
expect([...document.querySelectorAll('#verdict-bars td.bars')].every(cell =>
  cell.textContent !== '-' || cell.querySelector('.bar').offsetWidth === 0), 'a bar for what was not measured');
const headings = id => [...$(id).querySelectorAll('thead th button')];
expect(headings('verdict-bars').length === 11, 'columns of the first table');
expect($('verdict-bars').querySelector('a[href^="https://doi.org/10."]')?.title, 'no builder has a link to its paper');
for (const heading of headings('verdict-bars').slice(1, -1)) sorts('verdict-bars', heading);
expect(getComputedStyle(headings('verdict-bars')[0]).visibility === 'visible' &&
       headings('verdict-bars')[0].getBoundingClientRect().left >= 0, 'the headings of the first table are not seen');
choose('verdict-scene', values('verdict-scene')[1]);
expect($('verdict-bars').querySelectorAll('th[aria-sort="descending"], th[aria-sort="ascending"]').length === 1, 'another choice forgets the order');
choose('verdict-scene', '');
sorts('accuracy-table', headings('accuracy-table').find(button => button.textContent === 'Mrays/s'));

/* A filter leaves what it names. */
const filter = $('accuracy-table').querySelector('input[type="search"]');
filter.value = 'moller';
filter.dispatchEvent(new Event('input', { bubbles: true }));
expect(rows('accuracy-table').length > 0 && rows('accuracy-table').every(row => row.textContent.includes('moller')), 'the filter');

/* The arrow keys go through the rows, and each shows its mark's record. */
const region = $('accuracy-table').querySelector('[role="region"]'), tooltip = Chart.getChart('chart-accuracy').tooltip;
const press = (node, key) => node.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true }));
region.focus();
for (const [key, row] of [['ArrowDown', 0], ['ArrowDown', 1], ['ArrowUp', 0]]) {
  press(document.activeElement, key);
  expect(document.activeElement === rows('accuracy-table')[row], `${key} does not lead to row ${row}`);
  expect(tooltip.opacity > 0 && tooltip.body.length === 1, `no record of row ${row}`);
}
document.activeElement.blur();
expect(Chart.getChart('chart-accuracy').tooltip.getActiveElements().length === 0, 'the record stays');

/* Every row and chart has the command that measures it again; a button copies it, with a clipboard and without. */
const copied = [];
for (const clipboard of [{ writeText: async text => copied.push(text) }, undefined]) {
  Object.defineProperty(navigator, 'clipboard', { value: clipboard, configurable: true });
  document.execCommand = () => copied.push(document.activeElement.value);
  const records = JSON.parse($('data').textContent), keys = new Set([...records.traces, ...records.builds].map(row => row.cell));
  const made = rows('traces-tables').filter(row => !row.textContent.includes('rays as given') && row.querySelector('button.copy'));
  expect(made.length === 187, `${made.length} rows have a command`);
  for (const row of made.slice(0, 5)) {
    const before = copied.length, button = row.querySelector('button.copy');
    button.click();
    await Promise.resolve();
    const [, key] = (copied[before] || '').match(/^bvhbench run --cell (\S+)$/) || [];
    expect(copied.length === before + 1 && keys.has(key), `a row copies ${copied[before]}`);
  }
}
for (const tools of document.querySelectorAll('.chart-tools')) {
  const code = tools.querySelector('code').textContent, before = copied.length;
  const rays = /--rays \S+ .*--size 256x256 --max-rays 65536 --seed 7$/;
  expect(/^bvhbench run --scene \S+ /.test(code) && (rays.test(code) || tools.closest('#growth')), `${tools.closest('figure').querySelector('h3').textContent}: '${code}'`);
  tools.querySelector('button.copy').click();
  await Promise.resolve();
  expect(copied[before] === code, `copies ${copied[before]}`);
}
findings.push(...exerciseFiles(['wrong rays per million', 'bvhbench run --cell']));

/* Everything can be reached by its name, and nothing is wider than the page. */
for (const node of document.querySelectorAll('select, input, button'))
  expect(node.labels?.length > 0 || node.textContent.trim() !== '', `a ${node.tagName} without a name`);
expect(document.documentElement.scrollWidth <= window.innerWidth, `the page is ${document.documentElement.scrollWidth} wide`);
for (const event of ['beforeprint', 'afterprint']) window.dispatchEvent(new Event(event));

const result = document.createElement('p');
result.id = 'exercised';
result.textContent = findings.length ? `EXERCISE: ${findings.slice(0, 5).join('; ')}` : `EXERCISE: ${choices} choices, all well`;
document.body.append(result);
})();
