/* Looks through the page of two runs side by side: each cell has both figures and their ratio, charts have both runs, at most eight series of
 * a chart stand out. What it found stands in an element of its own. */
(() => {
const $ = id => document.getElementById(id), findings = [];
const expect = (ok, what) => { if (!ok) findings.push(what); };
const against = JSON.parse($('against-data').textContent), rows = () => [...$('against').querySelectorAll('tbody tr')];
const entry = (row, i) => row.children[i].textContent;

expect(!$('against').hidden && rows().length === against.rows.length && rows().length > 100, `${rows().length} rows of ${against.rows.length}`);
expect(/Old: old.json, .*New: new.json, .*2 figures worse/.test($('against-what').textContent), $('against-what').textContent);
const heads = [...$('against').querySelectorAll('thead button')].map(button => button.textContent);
const [old, now, ratio, verdict] = ['Old', 'New', 'Ratio [95 %]', 'Verdict'].map(name => heads.indexOf(name));
against.rows.forEach((row, i) => {
  expect(Math.abs(parseFloat(entry(rows()[i], ratio)) - row.new / row.old) < 0.001, `row ${i}: ${entry(rows()[i], ratio)}`);
  expect(entry(rows()[i], old) !== '-' && entry(rows()[i], now) !== '-', `row ${i} lacks a figure`);
});
expect(rows().filter(row => entry(row, verdict) === 'worse').length === 2, 'what is worse');
const odd = $('against').querySelector('input[type="checkbox"]');
odd.click();
expect(rows().length === 2, `${rows().length} rows moved`);
odd.click();

/* Charts have both runs of each builder, in one colour. */
const charts = ['chart-image', 'chart-builders', 'chart-time', 'chart-build'], seriesOf = id => Chart.getChart(id).data.datasets.filter(set => set.own);
for (const id of charts) {
  const names = seriesOf(id).map(set => set.label), olds = names.filter(name => name.endsWith(' (old)'));
  expect(olds.length > 2 && olds.length * 2 === names.length, `${id}: ${names}`);
  for (const name of olds) {
    const [a, b] = [name, name.replace(' (old)', ' (new)')].map(label => seriesOf(id).find(set => set.label === label));
    expect(b && a.own === b.own, `${id}: ${name} has another colour`);
  }
}

/* At most eight series stand out; one that is grey has its colour while its button in a legend is pointed at or has the keyboard. */
let greys = 0;
for (const id of charts) {
  const colours = () => new Map(seriesOf(id).map(set => [set.label, set.borderColor === set.own])), before = colours();
  const grey = [...before].filter(([, isOwn]) => !isOwn).map(([name]) => name);
  expect(before.size > 8 && before.size - grey.length === 8, `${id}: ${before.size - grey.length} series of ${before.size} stand out`);
  for (const name of grey) {
    const button = [...document.querySelectorAll('.legend button')].find(node => node.textContent === name);
    if (!button) { findings.push(`${name} has no legend`); continue; }
    button.dispatchEvent(new Event('focus'));
    expect(colours().get(name), `${id}: ${name} stays grey`);
    button.dispatchEvent(new Event('blur'));
    expect(!colours().get(name), `${id}: ${name} does not turn grey again`);
    greys++;
  }
}
findings.push(...exerciseFiles(['Ratio [95 %]']));
expect(document.documentElement.scrollWidth <= window.innerWidth, `the page is ${document.documentElement.scrollWidth} wide`);
const said = findings.length ? findings.slice(0, 6).join('; ') : `${charts.length} charts, all well`;
document.body.append(Object.assign(document.createElement('p'), { textContent: `EXERCISE: ${said}` }));
})();
