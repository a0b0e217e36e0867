/* Axes of Chart.js, in the page's colours. */
const colourOf = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

const axisOf = (text, log) => ({
  type: log ? 'logarithmic' : 'linear', title: { display: true, text, color: colourOf('--text') },
  grid: { color: colourOf('--line') },
  ticks: { color: colourOf('--muted'), maxTicksLimit: 8, callback: value => figure(value, Number.isInteger(value) && value < 100 ? 0 : -1) },
});
