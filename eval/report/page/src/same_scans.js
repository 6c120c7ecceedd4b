function isSame(a, b) {
  return a.sequence === b.sequence && a.scans.length === b.scans.length && a.scans.every(({ stem }, k) => stem === b.scans[k].stem);
}

/** Positions of the other results of the same sequence. */
export function resultsOfSameScans({ results }, position) {
  return results.flatMap((other, i) => (i !== position && isSame(other.result, results[position].result) ? [i] : []));
}
