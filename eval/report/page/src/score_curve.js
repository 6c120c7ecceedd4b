import { percent } from './format.js';
import { RUN_LINES, runLine } from './theme.js';

/** Precision at the first threshold that reaches each recall of `x`; null beyond the curve. */
export function precisionAt({ recall, precision }, x) {
  let i = 0;
  return x.map((wanted) => {
    while (i < recall.length && recall[i] < wanted) ++i;
    return i < recall.length ? precision[i] : null;
  });
}

/** Each curve at its own points of the common axis, null between them. */
function spread(curves) {
  const all = curves.flatMap(({ recall, precision }, c) => recall.map((x, i) => ({ x, c, y: precision[i] })));
  all.sort((a, b) => a.x - b.x); // a stable sort: equal recalls of a curve stay in order
  return { x: all.map(({ x }) => x), drawn: curves.map((_, c) => all.map((point) => (point.c === c ? point.y : null))) };
}

/** Those of `curves` that hold one of the results, with its place among them, as far as there are lines to tell them apart. */
function placed(curves, results) {
  const found = (curves ?? []).map((curve) => ({ ...curve, place: results.findIndex((i) => curve.results.includes(i)) }));
  return found.filter(({ place }) => place >= 0 && place < RUN_LINES.length).sort((a, b) => a.place - b.place);
}

/**
 * Precision over recall for all thresholds of the scores, a line per run that kept scores, drawn as the place of its
 * result in `shown` is elsewhere (null: not to be drawn), and a dot where its labels are; null without any.
 */
export function scoreCurveChart(curves, shown) {
  const wanted = placed(curves, shown);
  if (wanted.length === 0) return null;
  const { x, drawn } = spread(wanted);
  const ticks = (_, values) => values.map((v) => `${Math.round(100 * v)} %`);
  return {
    key: 'curve',
    title: 'Precision over recall',
    note: 'for every threshold of the score; the dot is what the labels reach, AP average precision',
    x,
    series: wanted.map((curve, c) => ({
      label: `${curve.run}, AP ${percent(curve.average_precision)}`, values: precisionAt(curve, x), drawn: drawn[c],
      spanGaps: true, points: { show: curve.recall.length < 3 }, ...runLine(curve.place),
    })),
    options: {
      text: percent, xLabel: 'recall', xValue: (_, v) => (v === null || v === undefined ? '–' : percent(v)), xScale: { range: [0, 1.01] }, xAxis: { values: ticks },
      yScale: { range: [0, 1.02] }, yAxis: { values: ticks },
      marks: wanted.map(({ labels, place }) => ({ x: labels.recall, y: labels.precision, colour: runLine(place).colour })),
    },
  };
}
