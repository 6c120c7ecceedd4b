/** Metrics of one scan from the counts in result.json; null where they are undefined. */

function ratio(part, whole) {
  return whole > 0 ? part / whole : null;
}

export function iou({ tp, fp, fn }) {
  return ratio(tp, tp + fp + fn);
}

export function precision({ tp, fp }) {
  return ratio(tp, tp + fp);
}

export function recall({ tp, fn }) {
  return ratio(tp, tp + fn);
}

/** Whether a scan of result.json has truth. */
export function hasCounts(scan) {
  return scan.tp !== undefined;
}

/** Whether a scan has labels; a scan that `mosbench score` left out has none. */
export function hasLabels(scan) {
  return scan.predicted_moving_points !== undefined;
}

/** Of those of `among` that `tells`, the one in the middle by `value`; null where there is none. */
function medianScan(among, tells, value) {
  const ordered = among.filter(tells).sort((a, b) => value(a) - value(b) || a - b);
  return ordered[Math.floor(ordered.length / 2)] ?? null;
}

/**
 * Of `among`, the scan with the median IoU of those in which something moves and the method looked for it: what
 * one may expect to see. Without truth that with the median number of points labelled moving. null where there is none.
 */
export function typicalScan({ scans, scans_without_detection: idle = [] }, among) {
  const looked = (k) => !idle.includes(scans[k].stem);
  const judged = medianScan(among, (k) => hasCounts(scans[k]) && scans[k].tp + scans[k].fn > 0 && looked(k), (k) => iou(scans[k]));
  const moving = (k) => scans[k].predicted_moving_points;
  return judged ?? medianScan(among, (k) => moving(k) > 0 && looked(k), moving);
}

/**
 * Indices of the scans with false points, most first. Those in which the method did not look for
 * motion yet come last: what it misses there says nothing about it.
 */
export function worstScans({ scans, scans_without_detection: idle = [] }) {
  const wrong = (k) => scans[k].fp + scans[k].fn;
  const isIdle = scans.map((scan) => idle.includes(scan.stem));
  return [...scans.keys()]
    .filter((k) => hasCounts(scans[k]) && wrong(k) > 0)
    .sort((a, b) => isIdle[a] - isIdle[b] || wrong(b) - wrong(a) || a - b);
}
