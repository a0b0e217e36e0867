/* Command lines that measure what is shown once more, and buttons that copy them. */
const quoted = word => /^[\w.,:=+/%@-]+$/.test(word) ? word : `'${word.replaceAll("'", `'\\''`)}'`;

/* The words of a command line, as a shell takes them. */
const wordsOf = command => [...command.matchAll(/(?:[^\s'\\]|'[^']*'|\\')+/g)].map(([word]) =>
  word.replace(/'([^']*)'|\\'/g, (_, inner) => inner ?? "'"));

/* What a run was told of its device, plug-ins and tracers in files: without it, it can't be repeated. */
function toldOf(run) {
  const words = wordsOf((run ? (data.merged || [])[run - 1] : data.context)?.command || '');
  return words.flatMap((word, i) => {
    const [, name, own] = word.match(/^--(device|form|handover|kernels-from|plugin|tracer)(?:=([^]*))?$/) || [];
    const value = own ?? words[i + 1];
    return name && value && (name !== 'tracer' || /\.so\b/.test(value)) ? [`--${name} ${quoted(value)}`] : [];
  });
}

const commandOf = (run, options) => ['bvhbench run', ...toldOf(run),
  ...options.flatMap(([name, values]) => values.length ? [`--${name} ${quoted(unique(values).join(','))}`] : [])].join(' ');

/* Of a row with a key; rays of another program can't be made again. */
const rowCommand = row => row.cell && !row.cell.includes('/rays-hash=') ? commandOf(runOf(row), [['cell', [row.cell]]]) : '';

/* Size, number and seed of rays, as a key has them. */
const partOfKey = (key, name) => key.match(new RegExp(`/${name}=([^/]*)`))?.[1];

/* Of all of these traces that can be made again, with rays like those of the first, whatever their views. */
function tracesCommand(all) {
  const first = all.find(rowCommand), like = t => [runOf(t), ...['size', 'max-rays', 'seed'].map(name => partOfKey(t.cell, name))].join();
  if (!first) return '';
  const list = all.filter(t => rowCommand(t) && like(t) === like(first));
  const ours = list.filter(t => !t.reference), native = list.filter(t => t.reference), values = (rows, name) => rows.map(t => t[name]).filter(Boolean);
  const own = ['size', 'max-rays', 'seed'].map(name => [name, [partOfKey(list[0].cell, name)].filter(Boolean)]);
  return commandOf(runOf(list[0]), [['scene', values(list, 'scene')], ['rays', values(list, 'rays')], ['builder', values(ours, 'builder')],
    ['tracer', values(native, 'builder')], ['kernel', values(ours, 'kernel')], ['intersector', values(ours, 'intersector')], ...own]);
}
/* Of a cell of the charts: of each view that it sums up. */
function cellCommand(cell) {
  const anyView = t => `${t.cell.replace(/\/view=[^/]*/, '')} ${runOf(t)}`;
  const views = cell.views === 1 ? [cell.t] : traces.filter(t => anyView(t) === anyView(cell.t));
  return views.every(rowCommand) ? commandOf(runOf(cell.t), views.map(t => ['cell', [t.cell]])) : '';
}

/* Of builds alone. */
const buildsCommand = list => list.length === 0 ? '' : commandOf(runOf(list[0]),
  [['scene', list.map(b => b.scene)], ['builder', list.map(b => b.builder)], ['rays', ['none']]]);

/* Where there is no clipboard for pages, such as for files in some browsers, the old way; false: neither. */
async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const area = el('textarea', { readonly: true, 'aria-hidden': 'true', class: 'skip' }), before = document.activeElement;
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand('copy');
    area.remove();
    before?.focus();
    return done;
  }
}

/* A button that copies what `text()` is then, and says so for a while. */
function copyButton(name, text, title) {
  const button = el('button', { type: 'button', class: 'copy', title, 'aria-label': `${name}: copy the command that measures this again` }, name);
  button.addEventListener('click', async () => {
    button.textContent = await copyText(text()) ? 'copied' : 'select it';
    setTimeout(() => { button.textContent = name; }, 1500);
  });
  return button;
}

/* A column of them; its texts are the commands. */
const commandColumn = command => ({ name: 'Repeat', title: 'the command that measures this row again', minor: true, text: command,
  node: row => el('td', { class: 'minor' }, command(row) ? copyButton('copy', () => command(row), command(row)) : dash) });
