/* Presses each button that saves or copies, and looks into what was saved: used by the exercises of pages. Returns what is wrong. */
function exerciseFiles(texts) {
  const findings = [], saved = [], expect = (ok, what) => { if (!ok) findings.push(what); };
  const makeUrl = URL.createObjectURL;
  URL.createObjectURL = blob => { saved.push({ content: blob.content }); return makeUrl.call(URL, blob); };
  window.Blob = class extends Blob { /* to be read at once */
    constructor(parts, options) { super(parts, options); this.content = parts[0]; }
  };
  document.addEventListener('click', event => {
    if (!event.target.download) return;
    saved.at(-1).name = event.target.download;
    event.preventDefault();
  }, true);
  const press = button => {
    const before = saved.length;
    button.click();
    expect(saved.length === before + 1 && saved[before].name, `${button.getAttribute('aria-label')} saves nothing`);
    return saved[before] || { name: '', content: '' };
  };

  const canvases = [...document.querySelectorAll('canvas')].filter(canvas => Chart.getChart(canvas) && canvas.width > 0 && canvas.offsetParent);
  expect(canvases.length > 0, 'no charts');
  for (const canvas of canvases) {
    const chart = Chart.getChart(canvas), name = canvas.id || canvas.getAttribute('aria-label'), card = canvas.closest('figure');
    const buttons = [...card.querySelectorAll('.chart-tools button')].filter(button => /^(PNG|SVG|CSV)$/.test(button.textContent));
    if (buttons.length !== 3) { findings.push(`${name}: ${buttons.length} buttons`); continue; }
    const [png, svg, csv] = buttons.map(press);
    const bytes = png.content;
    expect(png.name.endsWith('.png') && String.fromCharCode(...bytes.slice(1, 4)) === 'PNG' && bytes.length > 1000, `${name}: no PNG`);
    const text = svg.content, drawing = new DOMParser().parseFromString(text, 'image/svg+xml');
    expect(svg.name.endsWith('.svg') && !drawing.querySelector('parsererror') && !/NaN|undefined|href/.test(text), `${name}: no SVG`);
    const titled = Object.values(chart.options.scales).filter(axis => axis.title?.display && axis.title.text !== '');
    const titles = titled.flatMap(axis => [axis.title.text].flat());
    expect(titled.length === (chart.config.type === 'bar' ? 1 : 2), `${name}: an axis without a title`);
    const words = [...drawing.querySelectorAll('text')], labels = Object.values(chart.scales).flatMap(axis => axis.ticks.map(tick => tick.label));
    for (const word of [...titles, ...labels.flat().filter(Boolean)])
      expect(words.some(t => t.textContent === String(word)), `${name}: no '${word}' in the SVG`);
    /* What is drawn lies in the picture, and is not all clipped away. */
    document.body.append(drawing.documentElement);
    const box = document.querySelector('body > svg'), frame = box.getBoundingClientRect();
    for (const node of box.querySelectorAll('text')) {
      const at = node.getBoundingClientRect();
      expect(at.left > frame.left - 3 && at.right < frame.right + 3 && at.top > frame.top - 3 && at.bottom < frame.bottom + 3, `${name}: '${node.textContent}' is outside`);
    }
    const filled = [...box.querySelectorAll('path')].filter(node => node.getAttribute('fill') !== 'none').length;
    const marks = chart.getSortedVisibleDatasetMetas().reduce((sum, meta) => sum + meta.data.filter(e => e.options.radius > 0 || e.width > 0).length, 0);
    expect(filled >= marks, `${name}: ${filled} marks of ${marks} in the SVG`);
    box.remove();
    const lines = csv.content.split('\r\n'), { datasets } = chart.data;
    const rows = chart.config.type === 'bar' ? chart.data.labels.length : datasets.reduce((sum, set) => sum + set.data.length, 0);
    expect(csv.name.endsWith('.csv') && lines.length === rows + 2 && titles.every(title => lines[0].includes(title)), `${name}: ${lines.length} lines of CSV`);
  }
  const tables = [...document.querySelectorAll('table')].filter(table => table.caption?.querySelector('button'));
  expect(tables.length > 0, 'no tables to save');
  for (const table of tables) {
    const text = press(table.caption.querySelector('button')).content;
    const lines = text.match(/(?:"(?:[^"]|"")*"|[^"\r])*\r\n/g) || [], shown = table.querySelectorAll('tbody tr').length;
    expect(lines.length === shown + 1 && lines.join('') === text, `${table.caption.textContent}: ${lines.length} lines, ${shown} rows`);
  }
  for (const words of texts) expect(saved.some(file => typeof file.content === 'string' && file.content.includes(words)), `no file has '${words}'`);
  return findings;
}
