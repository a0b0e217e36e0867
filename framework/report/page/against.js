/* Two runs side by side: of each cell that both measured, both figures and their ratio (framework/report/report_against.c). */
const keyPart = name => ({ name, text: row => decoded(partOfKey(`/${row.cell}`, name.toLowerCase()) || dash), wide: name === 'Builder' });

/* A name that is no UTF-8 stays as it is in the key. */
function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

function startAgainst() {
  $('against').hidden = $('against-link').hidden = !against;
  if (!against) return;
  const side = of => [of.what, of.revision, of.date, of.host].filter(Boolean).join(', '), only = (count, of) => count > 0 ? `; ${count} in ${of} only` : '';
  $('against-what').textContent = `Old: ${side(against.old)}. New: ${side(against.new)}. ${plural(against.common, 'cell')} in both` +
    `${only(against.only_old, 'old')}${only(against.only_new, 'new')}; ${plural(against.worse, 'figure')} worse. A time is worse or better if its ratio ` +
    `is beyond 1 \u00b1 ${percent(against.floor)} and its 95 % interval excludes 1 (${against.floor_from}). Curves and small marks of the charts: old is dashed, or small.`;
  addTable($('against'), 'Cells of both runs. Press a heading to sort.', [
    ...['Builder', 'Scene', 'Rays', 'View', 'Kernel', 'Intersector', 'Layout'].map(keyPart), { name: 'Figure', text: row => row.figure },
    num('Old', row => row.old), num('New', row => row.new),
    { name: 'Ratio [95 %]', number: true, title: 'new / old', value: row => row.ratio,
      text: row => isNumber(row.ratio) ? row.ratio.toFixed(3) + (isNumber(row.low) ? ` [${row.low.toFixed(3)}, ${row.high.toFixed(3)}]` : '') : dash },
    { name: 'Verdict', text: row => row.verdict, css: row => row.verdict === 'worse' ? 'wrong' : '' },
    commandColumn(row => /\/(layout|run|rays-hash)=/.test(row.cell) ? '' : commandOf(1, [['cell', [row.cell]]])),
  ], against.rows, { tools: true, odd: row => ['worse', 'better', 'changed', 'undecided'].includes(row.verdict), oddly: 'only what moved' });
}
