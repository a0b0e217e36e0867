/* Colours, marks and short names of builders, kernels and intersectors: a series keeps its own whatever is chosen. */
const palettes = {
  light: ['#0b62b0', '#b8420f', '#17734a', '#8a3a9b', '#7a5a00', '#00727a', '#b0103e', '#5a5f66', '#4b6b00', '#4f46c4',
          '#9c4668', '#2b2b2b'],
  dark: ['#6cb4f5', '#f59563', '#5fce98', '#d293e3', '#d9b84a', '#54cdd4', '#f57f9d', '#b5b8bd', '#a9cc5a', '#a5a0ff',
         '#e3a3bd', '#f2f2f2'],
};
const dark = window.matchMedia('(prefers-color-scheme: dark)');
let printing = false;
const styleOf = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
function theme() {
  if (printing) return { page: '#ffffff', text: '#000000', muted: '#40464e', line: '#b8bdc4', grey: '#868d97' };
  return { page: styleOf('--panel'), text: styleOf('--text'), muted: styleOf('--muted'), line: styleOf('--line'), grey: styleOf('--grey') };
}
const colourAt = index => palettes[dark.matches && !printing ? 'dark' : 'light'][index % palettes.light.length];

const allCells = sets.flatMap(set => set.cells);
const namesOf = (cells, name) => unique(cells.map(name));
/* By merit, as in the summary of everything. */
const ranked = (summaries.choices[0] || { rows: [] }).rows;
const merit = cell => ranked.findIndex(row => row.builder === cell.t.builder && row.run === runOf(cell.t));
const byMerit = allCells.slice().sort((a, b) => merit(a) - merit(b));
const builderNames = namesOf(byMerit.filter(c => !c.reference), c => c.label);
const referenceNames = namesOf(byMerit.filter(c => c.reference), c => c.label);
const kernelNames = namesOf(allCells.filter(c => !c.reference), c => c.t.kernel);
const intersectorNames = namesOf(allCells.filter(c => !c.reference), c => c.t.intersector || '');

/* Names stand beside the marks, so that nothing is said by colour alone: without the parameters that all of one name share, and of the
 * others the values alone; in full where two would be the same. */
function shortNames(names) {
  const partsOf = name => name.match(/^([^:]*):?(.*)$/).slice(1);
  const parameters = name => partsOf(name)[1].split(',').filter(Boolean);
  const shorten = name => {
    const peers = names.filter(other => partsOf(other)[0] === partsOf(name)[0]);
    const telling = parameters(name).filter(p => !peers.every(peer => parameters(peer).includes(p)));
    return [partsOf(name)[0], telling.map(p => p.replace(/^[^=]*=/, '')).join(',')].filter(Boolean).join(':');
  };
  const short = names.map(shorten);
  return new Map(names.map((name, i) => [name, short.filter(s => s === short[i]).length > 1 ? name : short[i]]));
}
const shortBuilders = shortNames([...builderNames, ...referenceNames]), shortKernels = shortNames(kernelNames);
const builderKey = cell => shortBuilders.get(cell.label);
const kernelKey = cell => cell.reference ? builderKey(cell) : shortKernels.get(cell.t.kernel);
/* Old and new of one builder have one colour: the old one's curves are dashed, its marks small. */
const isOld = name => Boolean(against) && name.endsWith(' (old)');
const seriesOf = name => against ? name.replace(/ \((old|new)\)$/, '') : name;
const builderSeries = unique(builderNames.map(seriesOf));
const builderColour = cell => cell.reference ? theme().text : colourAt(builderSeries.indexOf(seriesOf(cell.label)));
const kernelColour = cell => cell.reference ? theme().text : colourAt(kernelNames.indexOf(cell.t.kernel));

/* By intersector: Chart.js' name, its rotation, and the sign for the legend. */
const shapes = [['circle', 0, '\u25cf'], ['triangle', 0, '\u25b2'], ['rect', 0, '\u25a0'], ['rectRot', 0, '\u25c6'],
                ['triangle', 180, '\u25bc'], ['triangle', 90, '\u25b6'], ['triangle', 270, '\u25c0']];
const shapeOf = cell => cell.reference ? ['crossRot', 0, '\u2715']
  : shapes[intersectorNames.indexOf(cell.t.intersector || '') % shapes.length];

/* ---- what is chosen ---- */
const picked = { scene: '', rays: '', view: '' };
const hidden = { builder: new Set(), kernel: new Set() };
function fillSelect(select, values, names, key) {
  if (!values.includes(picked[key])) picked[key] = values[0] ?? '';
  select.replaceChildren(...values.map((v, i) => el('option', { value: v }, names[i])));
  select.value = picked[key];
  select.disabled = values.length < 2;
}

/* The set that scene, rays and view name; an empty one if nothing was traced. */
function pick() {
  const scenes = unique(sets.map(s => s.scene));
  fillSelect($('pick-scene'), scenes, scenes, 'scene');
  const rays = unique(sets.filter(s => s.scene === picked.scene).map(s => s.rays));
  fillSelect($('pick-rays'), rays, rays, 'rays');
  const here = sets.filter(s => s.scene === picked.scene && s.rays === picked.rays);
  const only = here.length === 1 && here[0].cells.length > 0 ? here[0].cells[0].t.view : '';
  fillSelect($('pick-view'), here.map(s => s.view ?? ''),
             here.map(s => s.view ?? (s.views > 1 ? `all ${s.views} together` : only || 'whole scene')), 'view');
  return here.find(s => (s.view ?? '') === picked.view) || { scene: '', rays: '', cells: [], views: 0, incomplete: 0 };
}

const shown = cell => !hidden.builder.has(cell.label) && (cell.reference || !hidden.kernel.has(cell.t.kernel));
