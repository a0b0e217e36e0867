/* Charts of Chart.js: bars, lines or points. */
const colours = ['#4e79a7', '#f28e2b', '#59a14f', '#e15759', '#76b7b2', '#edc948', '#b07aa1', '#9c755f'];
const dashes = [[], [6, 3], [2, 2]];
const known = new Map(); /* series by name: each has the same colour in all charts */

const nameOf = row => row.filter(item => isText(item) && item !== '').join(', ');
const valueOf = item => isNumber(item.value) ? item.value : null;

/* The columns of numbers, by their places. */
const seriesOf = block => block.columns.map((column, i) => i).filter(i => !isTexts(block, i));

function datasetsOf(block) {
  const all = seriesOf(block), bars = block.drawing === 'bars', x = all[0];
  const point = (row, i) => ({ x: valueOf(row[x]), y: valueOf(row[i]), name: nameOf(row) });
  const isDrawn = p => p.x !== null && p.y !== null && (!block.xLog || p.x > 0) && (!block.yLog || p.y > 0);
  return (bars ? all : all.slice(1)).map(i => {
    const label = block.columns[i].heading, n = known.get(label) ?? known.size, colour = colours[n % colours.length];
    known.set(label, n);
    return {
      label, backgroundColor: colour, borderColor: colour, borderDash: dashes[Math.floor(n / colours.length) % dashes.length],
      borderWidth: bars ? 0 : 1.5, pointRadius: block.rows.length > 10 ? 1.5 : 3, showLine: block.drawing === 'lines',
      data: bars ? block.rows.map(row => valueOf(row[i])) : block.rows.map(row => point(row, i)).filter(isDrawn),
    };
  });
}

const plotOf = block => el('figure', { class: 'card' }, block.text ? el('h3', {}, block.text) : null,
  el('div', { class: 'plot' }, el('canvas', { role: 'img', 'aria-label': block.text || block.y })), el('div', { class: 'chart-tools' }));

/* Once it is on the page. */
function draw(block, canvas) {
  const bars = block.drawing === 'bars';
  if (bars) canvas.parentElement.style.height = `${5 + 2 * block.rows.length}rem`;
  const names = { stacked: true, grid: { display: false }, ticks: { color: colourOf('--muted'), autoSkip: false } };
  const chart = new Chart(canvas, {
    type: bars ? 'bar' : 'scatter', data: { labels: bars ? block.rows.map(nameOf) : undefined, datasets: datasetsOf(block) },
    options: {
      indexAxis: bars ? 'y' : 'x', animation: false, responsive: true, maintainAspectRatio: false,
      scales: bars ? { x: { ...axisOf(block.x, block.xLog), stacked: true }, y: names }
        : { x: axisOf(block.x, block.xLog), y: axisOf(block.y, block.yLog) },
      plugins: { legend: { labels: { color: colourOf('--text'), boxWidth: 12 } } },
    },
  });
  canvas.closest('figure').querySelector('.chart-tools').append(...chartButtons(() => chart, () => block.text || block.y));
}
