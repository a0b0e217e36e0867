/* Looks through the page of moving scenes: each method has its row and its curves, all finite, and winners are named. What it found stands in
 * an element of its own. */
(() => {
const findings = [];
const expect = (ok, what) => { if (!ok) findings.push(what); };

expect($('verdict').textContent === 'All answers in all frames are right.', $('verdict').textContent);
const sections = [...$('results').querySelectorAll('section')];
expect(sections.length === page.results.length && sections.length > 0, `${sections.length} results`);

let drawn = 0;
sections.forEach((section, number) => {
  const result = page.results[number], kinds = Object.keys(result.rays);
  const rows = [...section.querySelectorAll('table.methods tbody tr')];
  expect(rows.length === result.methods.length, 'a row for each method');
  rows.forEach((row, i) => {
    const cells = [...row.querySelectorAll('td')].map(td => td.textContent);
    expect(row.querySelector('th').textContent === result.methods[i].method, 'the name of a method');
    expect(cells.every(text => !/NaN|undefined|null/.test(text)), cells.join(' | '));
    expect(cells.at(-2) === '0' && /updated|rebuilt|kept/.test(cells.at(-1)), cells.join(' | '));
  });
  const others = result.methods.filter(m => m.method !== result.faster_than), faster = [...section.querySelectorAll('table.faster tbody tr')];
  expect(faster.length === others.length, 'a row for each other method');
  expect(faster.every(row => [...row.querySelectorAll('td')].every(td => /^(any number|none|(below |above |and |to |[0-9.e]+ ?)+)$/.test(td.textContent))), 'faster');
  const strip = section.querySelector('.strip img');
  expect(strip !== null && strip.naturalWidth > strip.naturalHeight * 2 && strip.width > 250, 'a strip of pictures');
  expect(section.querySelectorAll('table.winners tbody tr').length === kinds.length, 'a row of winners for each kind of rays');
  for (const id of ['update', 'cost', ...kinds.map((_, k) => `wins-${k}`)]) {
    const [name, k] = id.split('-'), chart = Chart.getChart(k === undefined ? `${name}-${number}` : `wins-${number}-${k}`);
    expect(chart.data.datasets.length === result.methods.length, `${id}: a curve for each method`);
    for (const set of chart.data.datasets)
      expect(set.data.length > 0 && set.data.every(p => Number.isFinite(p.x) && p.y > 0), `${id}: ${set.label}`);
    drawn++;
  }
});
const said = findings.length ? findings.join('; ') : `${drawn} charts, all well`;
document.body.append(Object.assign(document.createElement('p'), { textContent: `EXERCISE: ${said}` }));
})();
