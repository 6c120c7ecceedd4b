import { element } from './dom.js';
import { fixed } from './format.js';
import { toMap } from './motion_map.js';
import { OUTCOMES, REASONS } from './theme.js';

const vector = (numbers) => numbers.map((n) => n.toFixed(2)).join(', ');

/** The numbers of one point, with its outcome in every run that is shown. */
export function pointDetails(scans, pane, point, runs, scores) {
  const scan = scans[pane];
  const position = [...scan.positions_m.subarray(3 * point, 3 * point + 3)];
  const rows = [[scan.pose ? 'sensor x, y, z' : 'map x, y, z', `${vector(position)} m`]];
  if (scan.pose) {
    rows.unshift(['point', `${point} of ${scan.points}, scan ${scan.stem}`]);
    rows.push(['range', fixed(Math.hypot(...position), 2, 'm')]);
    rows.push(['map x, y, z', `${vector(toMap(scan.pose, ...position, [0, 0, 0]))} m`]);
  }
  if (scan.velocities_m_s) {
    const velocity = scan.velocities_m_s[point];
    rows.push(['radial velocity', Number.isNaN(velocity) ? 'not known' : fixed(velocity, 2, 'm/s')]);
  }
  const judged = scan.pose ? scans : [scan];
  judged.forEach((s, p) => {
    const run = judged.length > 1 ? runs[p] : null;
    rows.push([run ?? 'outcome', OUTCOMES[s.outcomes[point]].name]);
    if (s.scores) rows.push([run ? `${run}, ${scores[p]}` : scores[p], fixed(s.scores[point], Number.isInteger(s.scores[point]) ? 0 : 3)]);
    if (s.reasons) rows.push([run ? `${run}, reason` : 'reason', REASONS[s.reasons[point]].name]);
  });
  return element('dl', {}, ...rows.flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)]));
}
