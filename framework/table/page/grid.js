/* Tables of a page, which sort. */

const isText = item => typeof item === 'string';
const isTexts = (block, column) => block.rows.some(row => isText(row[column]));

function entry(item, column, isName) {
  if (isText(item)) return el(isName ? 'th' : 'td', isName ? { scope: 'row' } : {}, item);
  return el('td', { class: item.best ? 'number best' : 'number' }, figureWithInterval(item, column.decimals));
}

function gridOf(block) {
  const body = el('tbody'), state = { column: -1, down: false };
  const value = (row, i) => isText(row[i]) ? row[i] : row[i].value;
  const show = () => body.replaceChildren(...sorted(block.rows, state, value).map(row =>
    el('tr', {}, ...row.map((item, i) => entry(item, block.columns[i], i === 0)))));
  const heads = sortHeads(block.columns.map((column, i) =>
    ({ name: column.heading, title: column.help || null, css: isTexts(block, i) ? null : 'number' })), state, show);
  show();
  const figures = () => [block.columns.map(column => column.heading), ...sorted(block.rows, state, value).map(row => row.map((_, i) => value(row, i)))];
  return el('div', { class: 'scroll' }, el('table', {}, el('caption', {}, block.text, ' ', csvButton(block.text || page.title, figures)),
    el('thead', {}, el('tr', {}, ...heads)), body));
}
