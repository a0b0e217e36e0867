/* What is shown, as files: a chart as PNG, SVG or CSV, a table as CSV. They are made here; nothing is loaded. */

function saveFile(name, blob) {
  const link = el('a', { href: URL.createObjectURL(blob), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

/* RFC 4180; what a spreadsheet would take for a formula is marked as text. */
function csvEntry(value) {
  const text = typeof value === 'string' && /^(?:[=+@\t\r]|-[^\d.]*[A-Za-z(])/.test(value) ? `'${value}` : String(value ?? '');
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
const csvBlob = rows => new Blob([rows.map(row => `${row.map(csvEntry).join(',')}\r\n`).join('')], { type: 'text/csv' });

const fileName = (words, ending) => `${words.toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-|-$/g, '').slice(0, 80)}.${ending}`;

/* The figures of a chart: series, its axes, and the ends of the lines at its marks, where there are any. */
function chartRows(chart) {
  const { datasets, labels } = chart.data, { x, y } = chart.options.scales;
  const title = axis => [axis.title?.text || ''].flat().join(' ');
  if (chart.config.type === 'bar')
    return [['', ...datasets.map(set => `${set.label} (${title(x)})`)], ...labels.map((name, i) => [name, ...datasets.map(set => set.data[i])])];
  const points = datasets.flatMap(set => set.data.map(p => ({ series: set.label, ...p })));
  const ends = [['x low', p => p.xLow], ['x high', p => p.xHigh], ['y low', p => p.ySpread?.low], ['y high', p => p.ySpread?.high]]
    .filter(([, get]) => points.some(p => isNumber(get(p))));
  return [['series', title(x), title(y), ...ends.map(([name]) => name)],
          ...points.map(p => [p.series, p.x, p.y, ...ends.map(([, get]) => get(p))])];
}

function saveButton(text, what, save) {
  const button = el('button', { type: 'button', title: `save ${what}`, 'aria-label': `${text}: save ${what}` }, text);
  button.addEventListener('click', save);
  return button;
}

const csvButton = (name, rows) => saveButton('CSV', 'the figures of this table', () => saveFile(fileName(name, 'csv'), csvBlob(rows())));

/* Buttons for the chart that `chart()` gives, named `name()`. */
function chartButtons(chart, name) {
  const background = () => getComputedStyle(chart().canvas.closest('.card') || document.body).backgroundColor;
  const save = (ending, blob) => saveFile(fileName(name(), ending), blob);
  const png = () => {
    const { canvas } = chart(), whole = el('canvas', { width: canvas.width, height: canvas.height }), ctx = whole.getContext('2d');
    ctx.fillStyle = background();
    ctx.fillRect(0, 0, whole.width, whole.height);
    ctx.drawImage(canvas, 0, 0);
    const bytes = Uint8Array.from(atob(whole.toDataURL().split(',')[1]), letter => letter.charCodeAt(0));
    save('png', new Blob([bytes], { type: 'image/png' }));
  };
  return [saveButton('PNG', 'this chart as a picture', png),
          saveButton('SVG', 'this chart as a drawing', () => save('svg', new Blob([svgOf(chart(), background())], { type: 'image/svg+xml' }))),
          saveButton('CSV', 'the figures of this chart', () => save('csv', csvBlob(chartRows(chart()))))];
}
