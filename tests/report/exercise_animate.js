/* Looks through the page of moving scenes: each method has its row and its curves, all finite, and winners are named, in the
 * time that the record says. What it found stands in an element of its own. */
(() => {
const findings = [];
const expect = (ok, what) => { if (!ok) findings.push(what); };

expect($('verdict').textContent === 'All answers in all frames are right.', $('verdict').textContent);
const sections = [...$('results').querySelectorAll('section')];
expect(sections.length === page.results.length && sections.length > 0, `${sections.length} results`);

let drawn = 0;
sections.forEach((section, number) => {
  const result = page.results[number], kinds = Object.keys(result.rays);
  const rows = [...section.querySelectorAll('table.methods tbody tr')], kernels = result.methods[0].kernels;
  expect(rows.length === result.methods.length * kernels.length, 'a row for each method and kernel');
  rows.forEach((row, i) => {
    const cells = [...row.querySelectorAll('td')].map(td => td.textContent), method = result.methods[Math.floor(i / kernels.length)];
    expect(cells.every(text => !/NaN|undefined|null/.test(text)), cells.join(' | '));
    expect(cells.at(-1) === '0' && cells.includes(kernels[i % kernels.length].kernel), cells.join(' | '));
    if (i % kernels.length > 0) return;
    expect(row.querySelector('th').textContent === method.method, 'the name of a method');
    expect(/updated|rebuilt|kept/.test(row.querySelector('td.ways').textContent), cells.join(' | '));
  });
  const others = result.methods.filter(m => m.method !== result.faster_than), faster = [...section.querySelectorAll('table.faster tbody tr')];
  expect(faster.length === others.length, 'a row for each other method');
  expect(faster.every(row => [...row.querySelectorAll('td')].every(td => /^(any number|none|(below |above |and |to |[0-9.,e+]+ ?)+)$/.test(td.textContent))), 'faster');
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
/* The record's winners, where their curves are lowest and in the table beside. */
let winners = 0;
sections.forEach((section, number) => {
  const result = page.results[number], kinds = Object.keys(result.rays);
  const counts = [...new Set(result.winners.map(w => w.count))];
  kinds.forEach((kind, k) => {
    const curves = Chart.getChart(`wins-${number}-${k}`).data.datasets;
    const cells = [...section.querySelectorAll('table.winners tbody tr')[k].querySelectorAll('td')].map(td => td.textContent);
    for (const { count, method, kernel, frame_ms, as_fast } of result.winners.filter(w => w.rays === kind)) {
      const at = curves.map(set => ({ label: set.label, y: (set.data.find(p => Math.abs(p.x / count - 1) < 1e-9) || {}).y })).filter(p => p.y > 0);
      const lowest = at.reduce((a, b) => (b.y < a.y ? b : a), { y: Infinity }), cell = cells[counts.indexOf(count)];
      expect(Math.abs(lowest.y / frame_ms - 1) < 1e-6 && lowest.label === method, `${count} ${kind}: ${lowest.label} in ${lowest.y} ms, not ${method} in ${frame_ms} ms`);
      const others = as_fast.length > 0 ? `; as fast: ${as_fast.join(', ')}` : '';
      expect(cell === `${method}, ${kernel}: ${figure(frame_ms)} ms${others}`, `${count} ${kind}: '${cell}'`);
      winners++;
    }
  });
});
expect(winners > 0, 'no winners');
const said = findings.length ? findings.join('; ') : `${drawn} charts, all well`;
document.body.append(Object.assign(document.createElement('p'), { textContent: `EXERCISE: ${said}` }));
})();
