/* Tables sort by their headings: by a column, and once more the other way round. */

/* The headings of columns { name, title, css, down }; `down`: the largest first. `state` is { column, down }, column -1 at first;
 * `show` is called when it has changed, and shows the rows. */
function sortHeads(columns, state, show) {
  const mark = () => heads.forEach((head, i) =>
    head.setAttribute('aria-sort', i !== state.column ? 'none' : state.down ? 'descending' : 'ascending'));
  const heads = columns.map((column, i) => {
    const button = el('button', { type: 'button', title: column.title }, column.name);
    button.addEventListener('click', () => {
      Object.assign(state, { column: i, down: state.column === i ? !state.down : Boolean(column.down) });
      mark();
      show();
    });
    return el('th', { scope: 'col', class: column.css }, button);
  });
  mark();
  return heads;
}

/* `rows` in the order of `state`; value(row, column) is a number or a text. Rows without one stay last in both directions. */
function sorted(rows, state, value) {
  const missing = v => (v ?? '') === '' || v === dash || Number.isNaN(v);
  const order = (a, b) => isNumber(a) && isNumber(b) ? a - b : String(a).localeCompare(String(b), 'en', { numeric: true });
  return state.column < 0 ? rows : [...rows].sort((a, b) => {
    const [x, y] = [a, b].map(row => value(row, state.column));
    return missing(x) || missing(y) ? missing(x) - missing(y) : (state.down ? -1 : 1) * order(x, y);
  });
}
