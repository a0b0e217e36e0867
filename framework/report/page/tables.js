/* Tables that sort and filter. */
const classOf = (c, row) => [c.number && 'number', c.wide && 'wide', c.minor && 'minor', row && c.css && c.css(row)]
  .filter(Boolean).join(' ') || null;

/* A column: name, value(row) for sorting, text(row) for showing, node(row) for an entry of its own; number: right-aligned; down: sorts
 * with the largest first, as numbers do unless it is false; minor: not on paper; css(row): a class.
 * Settings: tools: a filter; odd(row): of which rows alone may be shown; state: kept by the caller; foot, css(row), narrow, compact,
 * name: of the table's class.
 * Returns its scrolling region, and the rows with their elements. */
function addTable(section, caption, columns, rows, settings) {
  const body = el('tbody'), table = el('table', { class: settings.name });
  const state = settings.state || { column: -1, down: false, words: [], odd: false };
  const status = el('span', { class: 'note', role: 'status' });

  const cells = rows.map(row => columns.map(c => c.text ? c.text(row) : row[c.key] ?? dash));
  const nodes = rows.map((row, r) => el('tr', { class: settings.css ? settings.css(row) : null },
    ...columns.map((c, i) => c.node ? c.node(row) : el(i === 0 ? 'th' : 'td', { scope: i === 0 ? 'row' : null, class: classOf(c, row) },
                                                       String(cells[r][i])))));
  const search = rows.map((row, r) => cells[r].join(' ').toLowerCase());
  const value = (r, i) => columns[i].value ? columns[i].value(rows[r]) : cells[r][i];

  function show() {
    const list = [...rows.keys()].filter(r => (!state.odd || settings.odd(rows[r])) &&
                                              state.words.every(word => search[r].includes(word)));
    body.replaceChildren(...sorted(list, state, value).map(r => nodes[r]));
    table.classList.toggle('sorted', state.column >= 0);
    status.textContent = `${list.length} of ${rows.length} rows`;
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
                      settings.odd ? el('label', {}, odd, ` ${settings.oddly || 'only wrong answers and rows without a result'}`) : null, status));
  }
  const heads = columns.map(c => ({ name: c.name, title: c.title, css: classOf(c), down: c.number && c.down !== false }));
  const figures = () => [columns.map(c => c.name), ...[...body.children].map(node => nodes.indexOf(node)).map(r =>
    columns.map((c, i) => typeof value(r, i) === 'number' ? value(r, i) : cells[r][i]))];
  table.append(el('caption', {}, caption, ' ', csvButton(caption.split('.')[0], figures)), el('thead', {}, el('tr', {}, ...sortHeads(heads, state, show))), body,
               ...(settings.foot ? [el('tfoot', {}, settings.foot)] : []));
  show();
  const css = ['scroll', settings.narrow && 'narrow', settings.compact && 'compact'].filter(Boolean).join(' ');
  const region = el('div', { class: css, role: 'region', tabindex: '0', 'aria-label': caption },
    table);
  section.append(region);
  return { region, rows: rows.map((row, r) => [row, nodes[r]]) };
}

const runColumn = merged ? [{ name: 'Run', number: true, value: runOf, text: row => against ? runName(runOf(row)) : runOf(row) + 1 }] : [];
const num = (name, get, title, text) =>
  ({ name, number: true, value: get, text: row => (text || figure)(get(row)), title });

/* ---- columns by the schema: heading, format and help of a field ---- */
const formats = { figure, whole, bytes, text: value => value || dash, pairs };
const inner = { profile: row => row.profile, tree: row => row.tree, accuracy: row => row.accuracy };

/* The field `name` of `part`; `change` overrides members of the column. */
function field(part, name, change) {
  const f = schema[part][name], get = row => ((inner[part] ? inner[part](row) : row) || {})[name];
  const number = ['figure', 'whole', 'bytes'].includes(f.format);
  return Object.assign({ name: f.heading, title: f.help, number, wide: f.format === 'pairs', value: number ? get : undefined,
                         text: row => formats[f.format](get(row)) }, change);
}
const fields = (part, names) => names.map(name => field(part, name));

/* A column of medians, of the field `median`; what is known of their spread stands in `name`_lo and so on. The heading says what
 * the brackets hold; a range among intervals says so itself. */
function medianColumn(part, median, rows, name) {
  const spreads = rows.map(row => spreadOf(row, name));
  const sure = spreads.some(s => s && s.isInterval);
  const what = sure ? ' [95 %]' : spreads.some(Boolean) ? ' [range]' : '';
  const text = row => {
    const spread = spreadOf(row, name), odd = sure && spread && !spread.isInterval;
    return figure(row[median]) + brackets(spread) + (odd ? ' range' : '');
  };
  return field(part, median, { name: schema[part][median].heading + what,
                               text: row => row.status === 'ok' ? text(row) : row.status });
}
const minor = columns => columns.map(column => Object.assign(column, { minor: true }));
const statusText = row => row.status === 'ok' ? 'ok' : row.reason ? `${row.status}: ${row.reason}` : row.status;

function traceTable() {
  addTable($('traces-tables'), 'Traces. Press a heading to sort; the table scrolls sideways.', [
    field('trace', 'builder'), ...runColumn, field('trace', 'scene'), field('trace', 'rays', { text: raysName }),
    ...fields('trace', ['view', 'kernel']),
    field('trace', 'native', { text: t => ({ true: 'native', false: 'reshaped' })[t.native] || dash }),
    field('trace', 'intersector'), medianColumn('trace', 'mrays_s', traces, 'mrays_s'),
    field('accuracy', 'wrong_ppm', { text: t => t.status === 'ok' ? wrongText(t) : dash,
      css: t => t.wrong || t.acc.overflowed > 0 ? 'wrong' : t.acc.wrong_ppm > 0 ? 'odd' : '' }),
    num(`/${embree}`, t => t.ratio, 'ratio to the fastest embree-native row on the same rays'),
    ...fields('accuracy', ['missed', 'false', 'wrong_t']), ...fields('trace', ['node_tests_per_ray', 'prim_tests_per_ray', 'work_per_ray']),
    num('First ray ms', t => t.reference ? t.record.build_ms_median : (t.record.first_ray_ms || {})[t.layout], 'boxes, build, transfer and layout'),
    ...minor([field('trace', 'count'), num('of', t => t.all, 'rays in the set', whole), field('trace', 'counted'),
    field('accuracy', 'overflowed'), ...fields('trace', ['query', 'layout', 'ms_median', 'sort_ms', 'event_ms', 'cpu_ms']),
    ...fields('accuracy', ['ties', 'margin_limited', 'oracle_wrong', 't_off', 't_ulp_p99', 't_ulp_max'])]),
    commandColumn(rowCommand),
    field('trace', 'status', { text: statusText, wide: true, css: t => t.status === 'ok' ? '' : 'odd' }),
  ], traces, { tools: true, css: t => t.reference ? 'reference' : null,
               odd: t => t.status !== 'ok' || t.acc.wrong_ppm > 0 || t.acc.overflowed > 0 });
  if (data.skipped.length > 0)
    addTable($('traces-tables'), 'Skipped: what was asked for and not traced, and why', [
      field('skipped', 'scene'), ...runColumn, ...fields('skipped', ['rays', 'view']),
      field('skipped', 'reason', { wide: true }),
    ], data.skipped, {});
}

function pairs(object, text = figure) {
  const list = Object.entries(object || {}).filter(([, v]) => v !== null);
  return list.length ? list.map(([k, v]) => `${k} ${typeof v === 'number' ? text(v) : String(v)}`).join(', ') : dash;
}
const bytePairs = object => pairs(object, bytes);

function buildTable() {
  const treeBytes = b => isNumber(b.bytes_native) ? b.bytes_native : (b.tree || {}).bytes_tree;
  addTable($('builds-tables'), 'Builds. Press a heading to sort; the table scrolls sideways.', [
    field('build', 'builder'), ...runColumn, ...fields('build', ['scene', 'mprims_s', 'build_handover']),
    medianColumn('build', 'build_ms_median', builds, 'build_ms'),
    ...(builds.some(b => b.untimed_ms > 0) ? [field('build', 'untimed_ms')] : []),
    ...minor(fields('build', ['cold_ms', 'boxes_ms', 'transfer_ms', 'prepare_ms', 'restore_ms', 'outside_ms', 'unseen_ms', 'inputs'])),
    ...metrics.map(m => num(m.title, b => metricOf(b, m), [m.full_title, m.unit].filter(Boolean).join(', '))),
    field('tree', 'depth'), ...minor(fields('tree', ['arity', 'nodes', 'refs'])),
    field('tree', 'bytes_tree', { value: treeBytes, text: b => bytes(treeBytes(b)) }),
    field('tree', 'bytes_peak'), ...(builds.some(b => (b.tree || {}).bytes_unbooked > 0) ? [field('tree', 'bytes_unbooked')] : []), field('build', 'layout_ms'),
    field('build', 'first_ray_ms', { text: b => b.reference ? figure(b.build_ms_median) : pairs(b.first_ray_ms) }),
    ...(builds.some(b => b.stage_ms) ? [...fields('build', ['stage_ms', 'stage_sah']),
      field('build', 'stage_bytes_peak', { text: b => bytePairs(b.stage_bytes_peak) }),
      ...minor([field('build', 'stage_bytes', { text: b => bytePairs(b.stage_bytes) })])] : []), ...minor(fields('build', ['first_ray_launches', 'first_ray_floor_ms', 'phase_ms', 'layout_sah', 'parameter'])),
    ...(builds.some(b => b.about) ? [field('build', 'about', { wide: true })] : []),
    commandColumn(rowCommand),
    field('build', 'status', { text: statusText, wide: true, css: b => b.status === 'ok' ? '' : 'odd' }),
  ], builds, { tools: true, css: b => b.reference ? 'reference' : null, odd: b => b.status !== 'ok' });
}

function sceneTable() {
  const size = s => ['x', 'y', 'z'].map(axis => figure(s[`hi_${axis}`] - s[`lo_${axis}`])).join(' \u00d7 ');
  addTable($('scenes-tables'), 'Scenes and their profiles', [
    ...fields('scene', ['name', 'kind', 'prims']), { name: 'Extent', text: size },
    ...fields('profile', ['flatness', 'size_min', 'size_median', 'size_max', 'overlap', 'zero_area', 'duplicate_centroids',
                          'code_bits']),
    field('scene', 'decision', { wide: true, text: s => pairs(s.decision) }),
    field('profile', 'closed', { text: s => ({ true: 'yes', false: 'no' })[(s.profile || {}).closed] || dash }),
    ...minor([field('scene', 'views', { text: s => Object.keys(s.views || {}).join(', ') || dash, wide: true }), field('scene', 'hash')]),
  ], data.scenes, {});
}

/* Runs merged with one that has no total have the steps only, whose total is then their sum. */
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
