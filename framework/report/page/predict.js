/* Do costs of trees predict what rays take? One chart and one table over all scenes, by kind of rays (framework/compare/prediction.h). */
const predictions = data.predictions || [];
/* How the fields of each begin, where a point has its figure, and its name. */
const costsOfTrees = [['mix_', 4, 'SAH and EPO, the best mix'], ['sah_', 2, 'SAH'], ['epo_', 3, 'EPO'],
                      ['work_', 5, 'counted work']];

const percent = value => isNumber(value) ? `${(100 * value).toFixed(1)} %` : dash;

/* "0.42 [0.38, 0.47]" */
const alphaText = p => isNumber(p.alpha) ? p.alpha.toFixed(2) +
  (isNumber(p.alpha_least) ? ` [${p.alpha_least.toFixed(2)}, ${p.alpha_most.toFixed(2)}]` : '') : dash;

function startPrediction() {
  $('prediction').hidden = predictions.length === 0;
  if (predictions.length === 0) return;
  $('pick-cost').replaceChildren(...costsOfTrees.filter(([name]) => predictions.some(p => isNumber(p[`${name}error`])))
    .map(([name, , title]) => el('option', { value: name }, title)));
  const errors = (name, title) => [
    field('prediction', `${name}error`, { name: title, text: p => percent(p[`${name}error`]) }), field('prediction', `${name}correlation`)];
  addTable($('prediction-table'), 'Typical deviation of the time per ray from each cost, and the correlation of their logarithms', [
    ...fields('prediction', ['rays', 'cells', 'groups', 'trees', 'scenes']),
    field('prediction', 'alpha', { name: 'alpha [range]', text: alphaText }), ...errors('mix_', 'Mix'),
    field('prediction', 'unseen_error', { text: p => percent(p.unseen_error) }), ...errors('sah_', 'SAH'), ...errors('epo_', 'EPO'),
    ...errors('work_', 'Work')], predictions, { compact: true });
}

/* Of the chosen rays, or of the first that have a fit. */
function drawPrediction(set) {
  if (predictions.length === 0) return;
  const kind = summaries.predictions.find(p => p.rays === set.rays) || summaries.predictions[0];
  const [name, at, title] = costsOfTrees.find(([cost]) => cost === $('pick-cost').value);
  const fit = predictions.find(p => p.rays === kind.rays);
  const points = kind.points.map(p => ({ cell: { t: traces[p[0]], label: label(traces[p[0]]), reference: false }, none: true,
                                         x: p[at], y: p[1] })).filter(p => shown(p.cell) && isNumber(p.x));
  const [across, up] = [points.map(p => p.x), points.map(p => p.y)].map(v => ({ min: Math.min(...v) * 0.97, max: Math.max(...v) * 1.03 }));
  const low = Math.max(across.min, up.min), high = Math.min(across.max, up.max);
  const sets = marksOf(points, c => c.label, builderColour);
  for (const s of sets) s.pointRadius = 4;
  if (points.length > 0)
    sets.push(line('cost tells the time', [{ x: low, y: low }, { x: high, y: high }], { borderDash: [6, 4] }));
  $('prediction-note').textContent = `Here: ${kind.rays}, ${plural(points.length, 'cell')}. The time deviates by ` +
    `${percent(fit[`${name}error`])} from this cost (correlation ${figure(fit[`${name}correlation`])})` +
    (name === 'mix_' && isNumber(fit.unseen_error) ? `, by ${percent(fit.unseen_error)} in a scene that the mix was not fitted to` : '') +
    (name === 'mix_' ? `; alpha ${alphaText(fit)}.` : '.');
  const ticks = { color: theme().muted, maxRotation: 0, callback: value => value.toFixed(2) };
  draw('chart-prediction', `Time per ray against ${title}`, sets,
       { x: axis(`${title}, by the mean of trees`, false, { ...(points.length > 0 ? across : {}), ticks }),
         y: axis('time per ray, by the mean of trees', false, { ...(points.length > 0 ? up : {}), ticks }) },
       p => p.cell ? [`${p.cell.t.scene}, ${raysName(p.cell.t)}${p.cell.t.view ? `, view ${p.cell.t.view}` : ''}`, p.cell.t.kernel,
                      `${title} ${p.x.toFixed(3)} of the mean, time ${p.y.toFixed(3)}`] : '',
       moreOf({ scene: '', rays: kind.rays }, points));
}
