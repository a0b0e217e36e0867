/* Tables that sort and filter. */
const classOf = (c, row) => [c.number && 'number', c.wide && 'wide', c.minor && 'minor', row && c.css && c.css(row)]
  .filter(Boolean).join(' ') || null;

/* A column: name, value(row) for sorting, text(row) for showing; number: right-aligned; minor: not on paper; css(row): a class.
 * Settings: tools: a filter; odd(row): of which rows alone may be shown; state: kept by the caller; foot, css(row), narrow, compact.
 * Returns its scrolling region, and the rows with their elements. */
function addTable(section, caption, columns, rows, settings) {
  const body = el('tbody');
  const headers = columns.map((column, i) => {
    const button = el('button', { type: 'button', title: column.title }, column.name);
    button.addEventListener('click', () => sortBy(i));
    return el('th', { scope: 'col', class: classOf(column), 'aria-sort': 'none' }, button);
  });
  const state = settings.state || { column: -1, down: false, words: [], odd: false };
  const status = el('span', { class: 'note', role: 'status' });

  const cells = rows.map(row => columns.map(c => c.text ? c.text(row) : row[c.key] ?? dash));
  const nodes = rows.map((row, r) => el('tr', { class: settings.css ? settings.css(row) : null },
    ...columns.map((c, i) => el(i === 0 ? 'th' : 'td', { scope: i === 0 ? 'row' : null, class: classOf(c, row) },
                                String(cells[r][i])))));
  const search = rows.map((row, r) => cells[r].join(' ').toLowerCase());

  function value(r) {
    const c = columns[state.column];
    const v = c.value ? c.value(rows[r]) : cells[r][state.column];
    return typeof v === 'number' ? (Number.isFinite(v) ? v : null) : v === dash || v === '' ? null : v;
  }
  /* Rows without a value stay last in both directions. */
  function compare(a, b) {
    const x = value(a) ?? null, y = value(b) ?? null;
    if (x === null || y === null) return (x === null) - (y === null) || a - b;
    const order = typeof x === 'number' && typeof y === 'number' ? x - y : String(x).localeCompare(String(y), 'en');
    return (state.down ? -order : order) || a - b;
  }
  function show() {
    const list = [...rows.keys()].filter(r => (!state.odd || settings.odd(rows[r])) &&
                                              state.words.every(word => search[r].includes(word)));
    if (state.column >= 0) list.sort(compare);
    body.replaceChildren(...list.map(r => nodes[r]));
    headers.forEach((th, k) => th.setAttribute('aria-sort', k !== state.column ? 'none' : state.down ? 'descending' : 'ascending'));
    status.textContent = `${list.length} of ${rows.length} rows`;
  }
  function sortBy(i) {
    state.down = state.column === i ? !state.down : Boolean(columns[i].number);
    state.column = i;
    show();
  }

  if (settings.tools) {
    const filter = el('input', { type: 'search', placeholder: 'words of a row', value: state.words.join(' ') });
    const odd = el('input', { type: 'checkbox' });
    const change = () => {
      Object.assign(state, { words: filter.value.toLowerCase().split(/\s+/).filter(Boolean), odd: odd.checked });
      show();
    };
    for (const input of [filter, odd]) input.addEventListener('input', change);
    section.append(el('div', { class: 'controls tools' }, el('label', {}, 'Filter ', filter),
                      settings.odd ? el('label', {}, odd, ' only wrong answers and rows without a result') : null, status));
  }
  show();
  const css = ['scroll', settings.narrow && 'narrow', settings.compact && 'compact'].filter(Boolean).join(' ');
  const region = el('div', { class: css, role: 'region', tabindex: '0', 'aria-label': caption },
    el('table', {}, el('caption', {}, caption), el('thead', {}, el('tr', {}, ...headers)), body,
       settings.foot ? el('tfoot', {}, settings.foot) : null));
  section.append(region);
  return { region, rows: rows.map((row, r) => [row, nodes[r]]) };
}

const runColumn = merged ? [{ name: 'Run', number: true, value: runOf, text: row => runOf(row) + 1 }] : [];
const num = (name, get, title, text) =>
  ({ name, number: true, value: get, text: row => (text || figure)(get(row)), title });
/* A column of medians. Its heading says what the brackets hold; a range among intervals says so
 * itself. */
function medianColumn(title, rows, name, get) {
  const spreads = rows.map(row => spreadOf(row, name));
  const sure = spreads.some(s => s && s.isInterval);
  const what = sure ? ' [95 %]' : spreads.some(Boolean) ? ' [range]' : '';
  const text = row => {
    const spread = spreadOf(row, name), odd = sure && spread && !spread.isInterval;
    return figure(get(row)) + brackets(spread) + (odd ? ' range' : '');
  };
  return { name: title + what, number: true, value: get,
           text: row => row.status === 'ok' ? text(row) : row.status };
}
const minor = columns => columns.map(column => Object.assign(column, { minor: true }));
const statusText = row => row.status === 'ok' ? 'ok' : row.reason ? `${row.status}: ${row.reason}` : row.status;

function traceTable() {
  const acc = (name, key, title) => num(name, t => t.acc[key], title, whole);
  addTable($('traces'), 'Traces. Press a heading to sort; the table scrolls sideways.', [
    { name: 'Builder', text: t => t.builder }, ...runColumn,
    { name: 'Scene', text: t => t.scene }, { name: 'Rays', text: raysName },
    { name: 'View', text: t => t.view || dash }, { name: 'Kernel', text: t => t.kernel },
    { name: 'Tree', text: t => ({ true: 'native', false: 'reshaped' })[t.native] || dash,
      title: 'native: the layout keeps the shape of the builder\u2019s own tree' },
    { name: 'Intersector', text: t => t.intersector || dash },
    medianColumn('Mrays/s', traces, 'mrays_s', t => t.mrays_s),
    { name: 'Wrong ppm', number: true, value: t => t.acc.wrong_ppm, text: t => t.status === 'ok' ? wrongText(t) : dash,
      css: t => t.wrong || t.acc.overflowed > 0 ? 'wrong' : t.acc.wrong_ppm > 0 ? 'odd' : '' },
    num('/Embree', t => t.ratio, 'ratio to the fastest embree-native row on the same rays'),
    acc('Missed', 'missed'), acc('False', 'false'), acc('Wrong t', 'wrong_t'),
    num('Box tests', t => t.node_tests_per_ray, 'per ray'), num('Prim. tests', t => t.prim_tests_per_ray, 'per ray'),
    ...minor([num('Rays traced', t => t.count, undefined, whole), num('of', t => t.all, 'rays in the set', whole),
    num('Counted', t => t.counted, 'rays whose tests were counted', whole),
    acc('Overflowed', 'overflowed', 'of the counted rays'),
    { name: 'Query', text: t => t.query || dash }, { name: 'Layout', text: t => t.layout || dash },
    num('ms', t => t.ms_median, 'median wall clock'), num('Event ms', t => t.event_ms, 'OpenCL profiling'),
    num('CPU ms', t => t.cpu_ms, 'process time of all threads'),
    acc('Ties', 'ties'), acc('Margin limited', 'margin_limited'), acc('Oracle wrong', 'oracle_wrong'),
    acc('t off', 't_off', 'right, but the distance is off by more than 1/1024 of it'),
    num('t error p99', t => t.acc.t_ulp_p99, 'units of the last place'),
    num('t error max', t => t.acc.t_ulp_max, 'units of the last place')]),
    { name: 'Status', text: statusText, wide: true, css: t => t.status === 'ok' ? '' : 'odd' },
  ], traces, { tools: true, css: t => t.reference ? 'reference' : null,
               odd: t => t.status !== 'ok' || t.acc.wrong_ppm > 0 || t.acc.overflowed > 0 });
  if (data.skipped.length > 0)
    addTable($('traces'), 'Skipped: what was asked for and not traced, and why', [
      { name: 'Scene', text: s => s.scene }, ...runColumn, { name: 'Rays', text: s => s.rays },
      { name: 'View', text: s => s.view || dash }, { name: 'Reason', text: s => s.reason || dash, wide: true },
    ], data.skipped, {});
}

function pairs(object) {
  const list = Object.entries(object || {}).filter(([, v]) => v !== null);
  return list.length ? list.map(([k, v]) => `${k} ${typeof v === 'number' ? figure(v) : String(v)}`).join(', ') : dash;
}

function buildTable() {
  const tree = (name, key, text) => num(name, b => (b.tree || {})[key], undefined, text);
  addTable($('builds'), 'Builds. Press a heading to sort; the table scrolls sideways.', [
    { name: 'Builder', text: b => b.builder }, ...runColumn, { name: 'Scene', text: b => b.scene },
    num('Mprims/s', b => b.mprims_s),
    medianColumn('Build ms', builds, 'build_ms', b => b.build_ms_median),
    ...minor([num('Cold ms', b => b.cold_ms, 'first build after allocation'),
              num('Boxes ms', b => b.boxes_ms, 'to make the input, if it is the primitives\u2019 boxes'),
              num('Transfer ms', b => b.transfer_ms, 'of the input to the host, of the tree back'),
              num('Prepare ms', b => b.prepare_ms, 'by the builder, before its first build, outside the clock'),
              num('Restore ms', b => b.restore_ms, 'by the builder, before each build, outside the clock'),
              num('Outside ms', b => b.outside_ms, 'on the host, in phases that the clock leaves out'),
              { name: 'Inputs', text: b => b.inputs || dash }]),
    tree('SAH', 'sah'), tree('EPO', 'epo'), tree('Depth', 'depth', whole),
    ...minor([tree('Arity', 'arity', whole), tree('Nodes', 'nodes', whole), tree('References', 'refs', whole)]),
    num('Tree', b => isNumber(b.bytes_native) ? b.bytes_native : (b.tree || {}).bytes_tree, undefined, bytes),
    tree('Peak', 'bytes_peak', bytes),
    { name: 'Layouts ms', text: b => pairs(b.layouts_ms), wide: true },
    ...(builds.some(b => b.stages_ms) ? [{ name: 'Stages ms', text: b => pairs(b.stages_ms), wide: true }] : []),
    ...minor([['Phases ms', 'phases_ms'], ['Layouts SAH', 'layouts_sah'], ['Parameters', 'params']].map(
      ([name, key]) => ({ name, text: b => pairs(b[key]), wide: true }))),
    ...(builds.some(b => b.about) ? [{ name: 'About the tree', text: b => b.about || dash, wide: true }] : []),
    { name: 'Status', text: statusText, wide: true, css: b => b.status === 'ok' ? '' : 'odd' },
  ], builds, { tools: true, css: b => b.reference ? 'reference' : null, odd: b => b.status !== 'ok' });
}

function sceneTable() {
  const profile = (name, key, title, text) => num(name, s => (s.profile || {})[key], title, text);
  const size = s => {
    const { lo, hi } = s.bounds || {};
    return Array.isArray(lo) && Array.isArray(hi) ? lo.map((v, i) => figure(hi[i] - v)).join(' \u00d7 ') : dash;
  };
  addTable($('scenes'), 'Scenes and their profiles', [
    { name: 'Scene', text: s => s.name }, { name: 'Kind', text: s => s.kind || dash },
    num('Primitives', s => s.prims, undefined, whole), { name: 'Extent', text: size },
    profile('Flatness', 'flatness', 'shortest by longest side'),
    profile('Smallest', 'size_min', 'box diagonal'), profile('Median', 'size_median', 'box diagonal'),
    profile('Largest', 'size_max', 'box diagonal'), profile('Overlap', 'overlap', 'other boxes that hold a centroid, mean'),
    profile('Zero area', 'zero_area', undefined, whole), profile('Equal centroids', 'duplicate_centroids', undefined, whole),
    profile('Code bits', 'code_bits', 'that separate the centroids', whole),
    { name: 'Closed', text: s => ({ true: 'yes', false: 'no' })[(s.profile || {}).closed] || dash },
    ...minor([{ name: 'Views', text: s => (s.views || []).join(', ') || dash, wide: true },
              { name: 'Hash', text: s => s.hash || dash }]),
  ], data.scenes, {});
}

/* Files of earlier versions have the steps only, whose total is then their sum. */
function stepTable() {
  const times = data.time_ms || {}, rows = [];
  const add = (name, ms) => { if (isNumber(ms)) rows.push({ name, ms }); };
  add('Builds, timed', times.build);
  add('Traces, timed', times.trace);
  for (const [name, ms] of Object.entries(data.steps_ms || {})) add(name, ms);
  add('Not accounted for', times.other);
  const total = times.total ?? rows.reduce((sum, row) => sum + row.ms, 0);
  const seconds = ms => (ms / 1000).toFixed(3);
  addTable($('steps'), `Seconds per step${isNumber(times.total) ? '' : '; those of builds and traces are not recorded'}`, [
    { name: 'Step', text: s => s.name },
    { name: 'Seconds', number: true, value: s => s.ms, text: s => seconds(s.ms) },
    { name: 'Share', number: true, value: s => s.ms, text: s => total > 0 ? `${(100 * s.ms / total).toFixed(1)} %` : dash },
  ], rows, { narrow: true, foot: el('tr', { class: 'total' }, el('th', { scope: 'row' }, 'Total'),
                                    el('td', { class: 'number' }, seconds(total)), el('td', {})) });
}
