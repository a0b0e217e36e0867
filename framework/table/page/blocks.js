/* The page: its blocks, one after the other. All text goes through textContent. */
const page = JSON.parse($('page').textContent);

/* What stands side by side. */
const rowsOfBlocks = { picture: 'pictures', plot: 'charts' };

function pictureOf(block) {
  const img = block.source ? el('img', { src: block.source, alt: block.text || block.path }) : null;
  const figure = el('figure', {}, img,
    el('figcaption', {}, img ? block.text : `${block.text}: not on this page, in its folder: ${block.path}`));
  if (img) img.onload = () => figure.classList.toggle('wide', img.naturalWidth > 2 * img.naturalHeight);
  return figure;
}

const makers = {
  heading: block => el('h2', {}, block.text),
  say: block => el('p', { class: 'note' }, block.text),
  note: block => el('p', { class: 'note' }, block.text),
  verdict: block => el('p', { class: block.good ? 'summary' : 'warning' }, block.text),
  picture: pictureOf,
  grid: gridOf,
  plot: plotOf,
};

document.title = page.title;
$('title').textContent = page.title;
for (const block of page.blocks) {
  const made = makers[block.kind](block), last = $('results').lastElementChild, row = rowsOfBlocks[block.kind];
  if (row && last && last.className === row) last.append(made);
  else $('results').append(row ? el('div', { class: row }, made) : made);
  if (block.kind === 'plot') draw(block, made.querySelector('canvas'));
}
