/* At most eight series of a chart stand out, in their colours. The others are grey until somebody points at one, in a chart or in a
 * legend, or reaches it there by the keyboard. */
const mostStanding = 8;
let pointedAt = null; /* the name of a series */

/* Those on a front or that win, then by merit; the best of the tracers with trees of their own is always among them. */
function standingOf(datasets) {
  const order = [...builderNames.slice(0, mostStanding / 2), ...referenceNames.slice(0, 1), ...builderNames.slice(mostStanding / 2), ...referenceNames.slice(1)];
  const rank = name => (datasets.some(set => set.label === name && set.data.some(p => p.front)) ? -1000 : 0) + order.indexOf(name);
  return new Set(unique(datasets.filter(set => set.own).map(set => set.label)).sort((a, b) => rank(a) - rank(b)).slice(0, mostStanding));
}

/* `own` is a series' colour, `width` that of its line. */
function paint(datasets) {
  const standing = standingOf(datasets), t = theme();
  for (const set of datasets.filter(s => s.own)) {
    const pointed = set.label === pointedAt, colour = pointed || standing.has(set.label) ? set.own : t.grey;
    Object.assign(set, { quiet: colour === t.grey, borderColor: colour, pointBorderColor: colour, order: pointed ? -1 : colour === t.grey ? 20 : 5,
                         pointBackgroundColor: set.data.map(p => p.none ? t.page : colour) });
    if (set.isLine) set.borderWidth = pointed ? set.width + 2 : set.width;
  }
}

function pointAtSeries(name) {
  if (name === pointedAt) return;
  pointedAt = name;
  for (const chart of Object.values(charts)) {
    paint(chart.data.datasets);
    chart.update('none');
  }
}

/* A button of a legend, which points while the pointer or the keyboard is on it. */
function seriesButton(name, colour, attributes) {
  const chip = el('i', { 'aria-hidden': 'true' }), button = el('button', { type: 'button', ...attributes }, chip, name);
  chip.style.background = colour;
  for (const [event, series] of [['mouseenter', name], ['focus', name], ['mouseleave', null], ['blur', null]])
    button.addEventListener(event, () => pointAtSeries(series));
  return button;
}
