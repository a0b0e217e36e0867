/* Uses the atlas as a person would: each part, manner and axis, an entry of the table, a method hidden. What it found stands in an element
 * of its own. */
(() => {
const findings = [];
const expect = (ok, what) => { if (!ok) findings.push(what); };
const choose = (id, value) => { $(id).value = value; $(id).dispatchEvent(new Event('change', { bubbles: true })); };
const values = id => [...$(id).options].map(option => option.value);
const cell = (axis, method) => {
  const head = [...$('table').querySelectorAll('thead th')].map(th => th.textContent);
  const row = [...$('table').querySelectorAll('tbody tr')].find(tr => tr.querySelector('th').textContent === axis);
  return row.children[head.indexOf(method)];
};

expect(values('pick-part').join() === 'builder,intersector', values('pick-part').join());
expect(values('pick-axis').join() === 'overlaid-edges,nan,sorted', values('pick-axis').join());
expect($('bugs').textContent.startsWith('No crash'), $('bugs').textContent);

/* A refusal is there for all; a limit that nobody promises to hold is told from what is wrong. */
expect(cell('nan', 'lbvh').textContent === 'refused 50' && cell('nan', 'null').textContent === 'refused 50', 'the refusal of corners');
choose('pick-part', 'intersector');
expect(cell('overlaid-edges', 'moeller').textContent.startsWith('wrong'), cell('overlaid-edges', 'moeller').textContent);
expect(cell('overlaid-edges', 'moeller').className === 'known', 'a known limit');
expect(cell('sorted', 'exact').textContent === '-', 'exact holds');

/* An entry leads to its axis. */
cell('overlaid-edges', 'moeller').querySelector('button').click();
expect($('axis-title').textContent === 'Edges behind edges', $('axis-title').textContent);
expect(!$('axis-known').hidden && $('axis-known').textContent.includes('ERROR_BUDGET'), 'where the limit is said');
expect($('axis-table').querySelectorAll('tbody tr').length > 0, 'its failures');
expect(!$('axis-figure').hidden && $('axis-picture').naturalWidth > 0, 'its picture');

/* A manner leaves the others out. */
choose('pick-manner', 'refused');
expect(cell('overlaid-edges', 'moeller').textContent === '-', 'no refusal there');
choose('pick-manner', '');

let drawn = 0;
for (const part of values('pick-part'))
  for (const axis of values('pick-axis')) {
    choose('pick-part', part);
    choose('pick-axis', axis);
    for (const id of ['wrong', 'trace', 'metric', 'build']) {
      const chart = Chart.getChart(`chart-${id}`), own = part === 'builder' || id === 'wrong' || id === 'trace';
      expect((chart.data.datasets.length === 2) === own, `${part} ${axis} ${id}: ${chart.data.datasets.length} curves`);
      for (const set of chart.data.datasets) expect(set.data.every(p => Number.isFinite(p.x) && p.y > 0), `${axis} ${id}: ${set.label}`);
      drawn++;
    }
  }

/* What is simulated, of two devices, has charts of its own. */
choose('pick-part', 'builder');
choose('pick-axis', 'overlaid-edges');
expect(values('pick-simulation').join() === 'simt:device=h100,width=32,simt:device=rx7900xtx,width=32', values('pick-simulation').join());
const bounds = values('pick-simulation').map(name => {
  choose('pick-simulation', name);
  const set = Chart.getChart('chart-simt').data.datasets.find(s => s.label === 'lbvh');
  expect(set && set.data.every(p => p.y > 0), `${name}: no bound`);
  expect(Chart.getChart('chart-efficiency').data.datasets.every(s => s.data.every(p => p.y > 0 && p.y <= 1)), `${name}: efficiency`);
  return set.data[0].y;
});
expect(bounds[0] !== bounds[1], 'the devices have one bound');

/* A method is hidden, and comes back. */
$('legend').querySelector('button').click();
expect(Chart.getChart('chart-trace').data.datasets.length === 1, 'one is hidden');
$('legend').querySelector('button').click();
expect(Chart.getChart('chart-trace').data.datasets.length === 2, 'both are back');

for (const node of document.querySelectorAll('select, button'))
  expect(node.textContent.trim() !== '' || node.closest('label') !== null, `no name: ${node.outerHTML.slice(0, 80)}`);
const said = findings.length ? findings.join('; ') : `${drawn} charts, all well`;
document.body.append(Object.assign(document.createElement('p'), { textContent: `EXERCISE: ${said}` }));
})();
