/* Chart.js as the charts use it: axes, marks with keys and intervals, stairs and curves. */
const charts = {};

/* The label of a tick on a logarithmic axis: only powers of ten have one. */
function powersOfTen(value) {
  if (!(Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-9)) return '';
  return value < 0.001 ? value.toExponential(0) : brief(value);
}

/* Of a thousand where there is little room. */
function tickLabel(value) {
  const crowded = this.isHorizontal() && this.width / Math.log10(this.max / this.min) < 45;
  return crowded && Math.round(Math.log10(value)) % 3 !== 0 ? '' : powersOfTen(value);
}

function axis(title, log, extra) {
  const t = theme();
  const grid = context => !log || (context.tick && powersOfTen(context.tick.value)) ? t.line : 'transparent';
  return Object.assign({
    type: log ? 'logarithmic' : 'linear',
    title: { display: true, text: title, color: t.text },
    grid: { color: grid, borderColor: t.muted },
    ticks: Object.assign({ color: t.muted, maxRotation: 0 }, log ? { callback: tickLabel, autoSkip: false } : {}),
  }, extra);
}

/* Whole decades around the values, so that a logarithmic axis has at least two labels. */
function decades(values) {
  const logs = values.filter(v => v > 0).map(Math.log10);
  if (logs.length === 0) return {};
  return { min: 10 ** Math.floor(Math.min(...logs) - 1e-9), max: 10 ** Math.ceil(Math.max(...logs) + 1e-9) };
}

/* Under the marks their intervals, or ranges, which are dashed, and for "at most" an arrow to the
 * left; over them as many names as find room. */
const annotations = {
  id: 'annotations',
  beforeDatasetsDraw(chart) {
    const { ctx, scales: { x, y } } = chart;
    ctx.save();
    ctx.lineWidth = 1;
    for (const set of chart.data.datasets) {
      for (const p of set.isLine ? [] : set.data) {
        const at = [x.getPixelForValue(p.x), y.getPixelForValue(p.y)];
        const stroke = (...points) => {
          ctx.beginPath();
          points.forEach(([px, py], i) => i ? ctx.lineTo(px, py) : ctx.moveTo(px, py));
          ctx.stroke();
        };
        const inside = px => Math.max(x.left, Math.min(x.right, px));
        ctx.strokeStyle = set.borderColor;
        if (p.none && p.atMost) stroke([at[0] - 7, at[1]], [at[0] - 20, at[1]], [at[0] - 15, at[1] - 4]);
        if (p.none && p.atMost) stroke([at[0] - 20, at[1]], [at[0] - 15, at[1] + 4]);
        const across = value => [inside(x.getPixelForValue(value)), at[1]];
        if (!p.none && isNumber(p.xLow)) stroke(across(p.xLow), across(p.xHigh));
        if (!p.ySpread) continue;
        ctx.setLineDash(p.ySpread.isInterval ? [] : [2, 3]);
        stroke(...[p.ySpread.low, p.ySpread.high].map(value => [at[0], y.getPixelForValue(value)]));
        ctx.setLineDash([]);
      }
    }
    ctx.restore();
  },
  afterDatasetsDraw(chart) {
    const { ctx, scales: { x, y } } = chart, placed = [];
    ctx.save();
    ctx.font = `11px ${Chart.defaults.font.family}`;
    const weight = p => (p.set.label === pointedAt ? 4 : 0) + (p.front ? 2 : 0) + (p.set.quiet ? 0 : 1);
    const points = chart.data.datasets.flatMap(set => set.data.filter(p => p.key && isNumber(p.y)).map(p => ({ ...p, set })));
    for (const p of points.sort((a, b) => weight(b) - weight(a))) {
      const width = ctx.measureText(p.key).width, [px, py] = [x.getPixelForValue(p.x), y.getPixelForValue(p.y)];
      if (py < y.top - 1 || py > y.bottom + 1) continue;
      const places = [[px + 8, py - 14], [px - 8 - width, py - 14], [px + 8, py + 4], [px - 8 - width, py + 4]];
      if (p.below) places.reverse();
      const free = ([left, top]) => left > 2 && left + width < chart.width - 2 && top > 0 &&
        !placed.some(b => left < b.right && left + width > b.left && Math.abs(top - b.top) < 11);
      const place = places.find(free);
      if (!place) continue;
      placed.push({ left: place[0], right: place[0] + width, top: place[1] });
      ctx.fillStyle = p.set.quiet ? theme().muted : theme().text;
      ctx.fillText(p.key, place[0], place[1] + 10);
    }
    ctx.restore();
  },
};

/* Under each chart: buttons for its files, and the command that measures it again. */
const about = {}; /* by chart: { name: of its files, command } */
function chartTools(id) {
  const copy = copyButton('Copy', () => about[id].command), code = el('code', { tabindex: '0' });
  const tools = el('div', { class: 'chart-tools' }, ...chartButtons(() => charts[id], () => about[id].name), copy, code);
  $(id).closest('figure').querySelector('figcaption').before(tools);
  return command => {
    code.textContent = command;
    code.hidden = copy.hidden = command === '';
  };
}

/* `lines(point)` gives the text that is shown where the pointer is. More: of: what is drawn, in words; command; hover(point or null)
 * is told of the pointer. */
function draw(id, name, datasets, scales, lines, more) {
  const t = theme(), { hover } = more;
  if (charts[id]) charts[id].destroy();
  const curves = datasets.filter(set => set.isLine).length, marks = datasets.reduce((sum, set) => sum + (set.isLine ? 0 : set.data.length), 0);
  paint(datasets);
  $(id).setAttribute('aria-label', `${name}: ${marks || !curves ? plural(marks, 'mark') : plural(curves, 'curve')}. The tables hold the same figures.`);
  about[id] = { show: about[id]?.show || chartTools(id), name: `${name} ${more.of}`, command: more.command };
  about[id].show(more.command);
  charts[id] = new Chart($(id), {
    type: 'scatter',
    data: { datasets },
    plugins: [annotations],
    options: {
      animation: false, responsive: true, maintainAspectRatio: false, layout: { padding: { right: 18, top: 6 } },
      interaction: { mode: 'nearest', intersect: true },
      onHover: (event, items) => {
        const set = items.length ? datasets[items[0].datasetIndex] : null;
        pointAtSeries(set && set.own ? set.label : null);
        if (hover) hover(set ? set.data[items[0].index] : null);
      },
      scales,
      plugins: {
        legend: { display: false },
        tooltip: {
          backgroundColor: t.page, borderColor: t.muted, borderWidth: 1, titleColor: t.text, bodyColor: t.text,
          displayColors: false, padding: 8, filter: item => !item.dataset.isLine || item.dataset.hasTip,
          callbacks: { title: items => items.length ? items[0].dataset.label : '', label: item => lines(item.raw) },
        } } } });
}

/* Shows the tooltip of the mark of `cell`, as if the pointer were on it; of none without a cell. */
function pointAt(id, cell) {
  const chart = charts[id], active = [];
  chart.data.datasets.forEach((set, datasetIndex) => set.data.forEach((p, index) => {
    if (cell && p.cell === cell && !set.isLine) active.push({ datasetIndex, index });
  }));
  chart.setActiveElements(active);
  chart.tooltip.setActiveElements(active, { x: 0, y: 0 });
  chart.update();
}

/* One dataset per series. Points: { cell, key, x, y, none, ... }; those that cannot be placed are left out. */
function marksOf(points, name, colour) {
  const placed = points.filter(p => isNumber(p.x) && isNumber(p.y));
  return unique(placed.map(p => name(p.cell))).map(label => {
    const list = placed.filter(p => name(p.cell) === label), own = colour(list[0].cell);
    return { label, data: list, own, pointRadius: isOld(list[0].cell.label) ? 4 : 6, pointHoverRadius: 8, pointBorderWidth: 2, clip: 10,
             pointStyle: list.map(p => shapeOf(p.cell)[0]), pointRotation: list.map(p => shapeOf(p.cell)[1]) };
  });
}

function line(name, points, style) {
  return Object.assign({ label: name, data: points, isLine: true, showLine: true, pointRadius: 0, pointHitRadius: 0,
                         borderColor: theme().muted, borderWidth: 1.5, order: 10, clip: false }, style);
}
