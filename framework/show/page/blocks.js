/* The page: its blocks, one after the other. All text goes through textContent. */
const page = JSON.parse($('page').textContent);

const makers = {
  heading: block => el('h2', {}, block.text),
  say: block => el('p', { class: 'note' }, block.text),
  verdict: block => el('p', { class: block.good ? 'summary' : 'warning' }, block.text),
  picture: block => el('figure', { class: 'picture' },
    block.source ? el('img', { src: block.source, alt: block.text || block.path }) : null,
    el('figcaption', {}, block.source ? block.text : `${block.text}: not on this page, in its folder: ${block.path}`)),
  grid: gridOf,
  plot: plotOf,
};

document.title = page.title;
$('title').textContent = page.title;
for (const block of page.blocks) {
  const made = makers[block.kind](block), last = $('results').lastElementChild;
  if (block.kind === 'picture' && last && last.className === 'pictures') last.append(made);
  else $('results').append(block.kind === 'picture' ? el('div', { class: 'pictures' }, made) : made);
  if (block.kind === 'plot') draw(block, made.querySelector('canvas'));
}
