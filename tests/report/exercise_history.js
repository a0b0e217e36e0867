/* Uses the history's page as a person would: each machine, figures and cells, the filter, the list of what moved. What it found stands in
 * an element of its own. */
(() => {
'use strict';
const $ = id => document.getElementById(id), findings = [];
const expect = (ok, what) => { if (!ok) findings.push(what); };
const choose = (id, value) => { $(id).value = value; $(id).dispatchEvent(new Event('change', { bubbles: true })); };
const values = id => [...$(id).options].map(option => option.value);
const rows = id => [...$(id).querySelectorAll('tbody tr')];
const chart = () => Chart.getChart('chart');
const marks = label => chart().data.datasets.find(set => set.label === label).data
  .flatMap((value, i) => value === null ? [] : [chart().data.labels[i]]);
const type = words => { $('filter').value = words; $('filter').dispatchEvent(new Event('input', { bubbles: true })); };

/* The machine of the latest run first: one revision, of which nothing can have moved. */
expect(values('pick-machine').length === 2, 'two machines');
expect($('where').textContent.includes('south') && $('where').textContent.includes('10 % assumed'), 'the south first, its floor assumed');
expect(rows('moves').length === 0 && rows('revisions').length === 1, 'nothing moved in the south');

choose('pick-machine', '1');
expect($('where').textContent.includes('5 revisions, 258 cells on north'), $('where').textContent);
expect(/[\d.]+ %: what 90 % of the cells do not exceed between runs of one revision/.test($('where').textContent), 'the floor as measured');
expect(rows('moves').length === 3, `${rows('moves').length} moves`);

/* What moved last is shown: it got better in the last revision. */
expect(marks('better').join() === 'eeee555555555' && marks('worse').length === 0, 'the latest move is marked');

/* Each move leads to its chart, marked at its revision only. */
for (const [row, label, revision, figure] of [[1, 'worse', 'dddd444444444', 'sah'], [2, 'worse', 'cccc333333333', 'ms'], [0, 'better', 'eeee555555555', 'ms']]) {
  rows('moves')[row].querySelector('button').click();
  expect(marks(label).join() === revision, `row ${row}: marks at ${marks(label)}`);
  expect($('pick-figure').value === figure, `row ${row}: ${$('pick-figure').value}`);
  const told = rows('revisions').filter(r => r.textContent.includes(label));
  expect(told.length === 1 && told[0].textContent.includes(revision), `row ${row}: the table of revisions`);
}

/* The band is around the median, at each revision. */
const [upper, lower, median] = ['upper end', 'lower end', 'median'].map(label => chart().data.datasets.find(set => set.label === label).data);
expect(median.length === 5 && median.every((m, i) => lower[i] <= m && m <= upper[i] && lower[i] < upper[i]), 'the band');

/* The filter leaves what it names; each figure of some cells can be drawn. */
type('builder=sah rays=ao');
const few = values('pick-cell');
expect(few.length > 0 && few.length < 258 && few.every(key => key.includes('builder=sah') && key.includes('rays=ao')), `the filter: ${few.length}`);
let drawn = 0;
for (const key of few) {
  choose('pick-cell', key);
  for (const figure of values('pick-figure')) {
    choose('pick-figure', figure);
    expect($('chart').getAttribute('aria-label').includes('5 revisions'), `${key} ${figure}`);
    drawn++;
  }
}
expect(drawn > 10, `${drawn} charts`);
type('no such cell');
expect(values('pick-cell').length === 0, 'no cell');
type('');
expect(values('pick-cell').length === 258, 'all cells again');

for (const node of document.querySelectorAll('select, input, button'))
  expect(node.labels?.length > 0 || node.textContent.trim() !== '', `a ${node.tagName} without a name`);
expect(document.documentElement.scrollWidth <= window.innerWidth, `the page is ${document.documentElement.scrollWidth} wide`);
rows('moves')[2].querySelector('button').click();

document.body.append(Object.assign(document.createElement('p'),
  { textContent: findings.length ? `EXERCISE: ${findings.slice(0, 5).join('; ')}` : `EXERCISE: ${drawn} charts, all well` }));
})();
