/* A chart as SVG: Chart.js draws it once more, and what it draws is written down. */

/* Takes a path as a canvas does; `d` is the same path for SVG. */
function svgPath() {
  const d = [];
  const put = (letter, ...values) => d.push(letter + values.map(v => Number(v.toFixed(2))).join(' '));
  return {
    d,
    moveTo: (x, y) => put('M', x, y),
    lineTo: (x, y) => put(d.length ? 'L' : 'M', x, y),
    bezierCurveTo: (...points) => put('C', ...points),
    quadraticCurveTo: (...points) => put('Q', ...points),
    rect: (x, y, w, h) => { put('M', x, y); put('H', x + w); put('V', y + h); put('H', x); d.push('Z'); },
    /* in two halves: SVG has no arc that ends where it begins */
    arc: (x, y, r, from, to, back) => {
      const at = angle => [x + r * Math.cos(angle), y + r * Math.sin(angle)];
      put(d.length ? 'L' : 'M', ...at(from));
      for (const angle of [(from + to) / 2, to]) put('A', r, r, 0, 0, back ? 0 : 1, ...at(angle));
    },
    closePath: () => d.push('Z'),
  };
}

/* Of a canvas's colour: fill="..." and its opacity; many programs take no rgba(). */
function svgColour(name, colour) {
  const parts = colour.match(/^rgba\((.*), ([\d.]+)\)$/);
  return parts ? { [name]: `rgb(${parts[1]})`, [`${name}-opacity`]: parts[2] } : { [name]: colour };
}

function svgOf(chart, background) {
  const { ctx, width, height } = chart, ratio = ctx.canvas.width / width, canvas = Object.getPrototypeOf(ctx);
  const svg = (tag, attributes, ...children) => {
    const node = document.createElementNS('http://www.w3.org/2000/svg', tag);
    for (const [name, value] of Object.entries(attributes)) if (value !== null) node.setAttribute(name, value);
    node.append(...children);
    return node;
  };
  const root = svg('svg', { xmlns: 'http://www.w3.org/2000/svg', width, height, viewBox: `0 0 ${width} ${height}` },
                   svg('title', {}, ctx.canvas.getAttribute('aria-label') || ''), svg('rect', { width, height, fill: background }));
  /* Lines are kept as Path2D, which cannot be read: they are made again. */
  const lines = new Map();
  for (const { dataset } of chart.getSortedVisibleDatasetMetas())
    if (dataset && dataset._path) {
      const path = svgPath();
      dataset.path(path, 0, dataset.points.length);
      lines.set(dataset._path, path);
    }
  let path = svgPath(), clip = null, clips = 0;
  const saved = [];
  const place = () => {
    const t = ctx.getTransform();
    const values = [t.a, t.b, t.c, t.d, t.e, t.f].map(v => Number((v / ratio).toFixed(4)));
    return { transform: values.join() === '1,0,0,1,0,0' ? null : `matrix(${values.join(' ')})` };
  };
  /* The clip stands around what it clips, whose own transformation does not move it. */
  const add = (...node) => root.append(clip ? svg('g', { 'clip-path': clip }, svg(...node)) : svg(...node));
  const ofPath = p => ({ d: (lines.get(p) || path).d.join(''), ...place() });
  const stroked = () => ({ fill: 'none', ...svgColour('stroke', ctx.strokeStyle), 'stroke-width': ctx.lineWidth,
                           'stroke-dasharray': ctx.getLineDash().join(' ') || null, 'stroke-linejoin': ctx.lineJoin });
  const asRect = (x, y, w, h) => { const p = svgPath(); p.rect(x, y, w, h); return { d: p.d.join(''), ...place() }; };
  const anchors = { center: 'middle', right: 'end', end: 'end' };
  const baselines = { middle: 'central', top: 'text-before-edge', hanging: 'hanging', bottom: 'text-after-edge' };
  const written = {
    beginPath: () => { path = svgPath(); },
    save: () => saved.push(clip),
    restore: () => { clip = saved.length ? saved.pop() : null; },
    fill: p => add('path', { ...ofPath(p), ...svgColour('fill', ctx.fillStyle) }),
    stroke: p => add('path', { ...ofPath(p), ...stroked() }),
    fillRect: (...r) => add('path', { ...asRect(...r), ...svgColour('fill', ctx.fillStyle) }),
    strokeRect: (...r) => add('path', { ...asRect(...r), ...stroked() }),
    clip: () => {
      const id = `clip${++clips}`, { transform } = place();
      root.append(svg('clipPath', { id, 'clip-path': clip }, svg('path', { d: path.d.join(''), transform })));
      clip = `url(#${id})`;
    },
    fillText: (text, x, y) => add('text', { x, y, ...place(), ...svgColour('fill', ctx.fillStyle), style: `font: ${ctx.font}`,
      'text-anchor': anchors[ctx.textAlign] || null, 'dominant-baseline': baselines[ctx.textBaseline] || null }, text),
  };
  for (const name of Object.keys(svgPath()).filter(key => key !== 'd')) written[name] = (...values) => path[name](...values);
  for (const [name, write] of Object.entries(written))
    ctx[name] = (...values) => {
      write(...values);
      return canvas[name].apply(ctx, values);
    };
  try {
    chart.draw();
  } finally {
    for (const name of Object.keys(written)) delete ctx[name];
  }
  return new XMLSerializer().serializeToString(root);
}
