import { fixed } from './format.js';
import { runLine } from './theme.js';

/** How far the poses of each run are off those of the data set, over the way driven; null where all took the latter. */
export function driftChart(entries, names) {
  const off = entries.flatMap(({ path }, i) => (path?.off_m ? [{ label: names[i], values: path.off_m, colour: runLine(i).colour }] : []));
  if (off.length === 0) return null;
  return {
    key: 'drift',
    title: 'Distance to the poses of the data set',
    note: 'metres over metres driven; first pose upon first pose',
    x: entries.find(({ path }) => path?.way_m).path.way_m,
    series: off,
    options: { text: (v) => fixed(v, 3, 'm'), xLabel: 'way', xValue: (_, v) => fixed(v, 1, 'm'), yScale: { range: (_, __, high) => [0, 1.05 * Math.max(high, 0.01)] } },
  };
}
