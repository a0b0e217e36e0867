/* Colours, marks and keys of builders, kernels and intersectors: a series keeps its own whatever is chosen. */
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
  if (printing) return { page: '#ffffff', text: '#000000', muted: '#40464e', line: '#b8bdc4' };
  return { page: styleOf('--panel'), text: styleOf('--text'), muted: styleOf('--muted'), line: styleOf('--line') };
}
const colourAt = index => palettes[dark.matches && !printing ? 'dark' : 'light'][index % palettes.light.length];

const allCells = sets.flatMap(set => set.cells);
const namesOf = (cells, name) => unique(cells.map(name));
const builderNames = namesOf(allCells.filter(c => !c.reference), c => c.label);
const referenceNames = namesOf(allCells.filter(c => c.reference), c => c.label);
const kernelNames = namesOf(allCells.filter(c => !c.reference), c => c.t.kernel);
const intersectorNames = namesOf(allCells.filter(c => !c.reference), c => c.t.intersector || '');

/* Keys stand beside the marks, so that nothing is said by colour alone: kernels A, B ... Z, AA; builders 1, 2 ...; references
 * R1, R2 ... */
function letters(index) {
  let text = '';
  for (let rest = index + 1; rest > 0; rest = Math.floor((rest - 1) / 26))
    text = String.fromCharCode(65 + (rest - 1) % 26) + text;
  return text;
}
const builderKey = cell => cell.reference ? `R${referenceNames.indexOf(cell.label) + 1}`
                                          : `${builderNames.indexOf(cell.label) + 1}`;
const kernelKey = cell => cell.reference ? builderKey(cell) : letters(kernelNames.indexOf(cell.t.kernel));
const builderColour = cell => cell.reference ? theme().text : colourAt(builderNames.indexOf(cell.label));
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
