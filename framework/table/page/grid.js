/* Tables that sort: a column's heading sorts by it, once more the other way round. */

const isText = item => typeof item === 'string';
const isTexts = (block, column) => block.rows.some(row => isText(row[column]));

function entry(item, column, isName) {
  if (isText(item)) return el(isName ? 'th' : 'td', isName ? { scope: 'row' } : {}, item);
  return el('td', { class: item.best ? 'number best' : 'number' }, figureWithInterval(item, column.decimals));
}

function before(a, b) {
  if (isText(a) || isText(b)) return String(a).localeCompare(String(b), 'en', { numeric: true });
  if (!isNumber(a.value) || !isNumber(b.value)) return isNumber(b.value) - isNumber(a.value);
  return a.value - b.value;
}

function gridOf(block) {
  const body = el('tbody', {}), heads = [];
  const fill = rows => body.replaceChildren(...rows.map(row =>
    el('tr', {}, ...row.map((item, i) => entry(item, block.columns[i], i === 0)))));
  const sortBy = i => {
    const down = heads[i].getAttribute('aria-sort') === 'ascending';
    heads.forEach(head => head.removeAttribute('aria-sort'));
    heads[i].setAttribute('aria-sort', down ? 'descending' : 'ascending');
    fill([...block.rows].sort((a, b) => (down ? -1 : 1) * before(a[i], b[i])));
  };
  block.columns.forEach((column, i) => {
    const button = el('button', { type: 'button', title: column.help || null }, column.heading);
    button.addEventListener('click', () => sortBy(i));
    heads.push(el('th', { scope: 'col', class: isTexts(block, i) ? null : 'number' }, button));
  });
  fill(block.rows);
  return el('div', { class: 'scroll' }, el('table', {}, block.text ? el('caption', {}, block.text) : null,
    el('thead', {}, el('tr', {}, ...heads)), body));
}
