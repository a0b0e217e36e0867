/* Looks through the page of a contest: each way has its row and its bar, each step of a march its point, each picture is shown. What it found
 * stands in an element of its own. */
(() => {
const findings = [];
const expect = (ok, what) => { if (!ok) findings.push(what); };
const rows = (section, table) => [...section.querySelectorAll(`table.${table} tbody tr`)];

expect($('verdict').textContent === 'All answers are the same to the last bit.', $('verdict').textContent);
expect($('title').textContent === document.title && document.title !== 'bvhbench', document.title);
const sections = [...$('results').querySelectorAll('section')];
expect(sections.length === page.results.length && sections.length > 0, `${sections.length} results`);

let drawn = 0;
sections.forEach((section, number) => {
  const result = page.results[number], ran = result.ways.filter(way => !way.refused);
  expect(rows(section, 'ways').length === result.ways.length, 'a row for each way');
  rows(section, 'ways').forEach((row, i) => {
    const way = result.ways[i], cells = [...row.querySelectorAll('td')].map(td => td.textContent);
    expect(row.querySelector('th').textContent === (way.builder ? `${way.builder}, ${way.kernel}` : 'no tree'), 'the name of a way');
    if (way.refused) expect(cells.join() === way.refused, `${cells}: refused`);
    else expect(cells.at(-1) === (way.builder ? '0' : '') && cells.every(text => !/NaN|undefined|null/.test(text)), cells.join(' | '));
  });
  if (result.tetrahedra) expect(result.ways.some(way => way.refused), 'lbvh has no octree, which a row says');
  const times = Chart.getChart(`times-${number}`);
  expect(times.data.labels.length === ran.length, 'a bar for each way');
  expect(times.data.datasets.every(set => set.data.every(v => Number.isFinite(v) && v >= 0)), 'lengths of bars');
  expect(times.data.datasets[2].data.every(v => v > 0), 'each answer took time');
  drawn++;
  for (const id of (result.accuracy || []).length ? ['steps', 'speed'] : [])
    for (const set of Chart.getChart(`${id}-${number}`).data.datasets) {
      expect(set.data.length === result.accuracy.length, `${id}: ${set.label}: ${set.data.length} points`);
      drawn++;
    }
  expect(rows(section, 'accuracy').length === (result.accuracy || []).length, 'a row for each step');
  const pictures = [...section.querySelectorAll('img')];
  expect(pictures.length > 0 && pictures.every(img => img.naturalWidth > 0 && img.alt !== ''), `${pictures.length} pictures`);
});
const said = findings.length ? findings.join('; ') : `${drawn} charts, all well`;
document.body.append(Object.assign(document.createElement('p'), { textContent: `EXERCISE: ${said}` }));
})();
