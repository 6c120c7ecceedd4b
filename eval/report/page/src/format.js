/** Numbers as text. */

export function percent(fraction) {
  return fraction === null || fraction === undefined ? 'undefined' : `${(100 * fraction).toFixed(1)} %`;
}

export function count(number) {
  return number === null || number === undefined ? '–' : number.toLocaleString('en-US');
}

export function fixed(number, digits, unit = '') {
  if (number === null || number === undefined) return '–';
  return `${number.toFixed(digits)}${unit ? ` ${unit}` : ''}`;
}

/** "protocol doals-hmm, 0.5 to 20 m": the rules of a number, with the range of the points that count. */
export function rulesText({ protocol, min_range_m: low, max_range_m: high }) {
  if (high > 0) return `protocol ${protocol}, ${low} to ${high} m`;
  return low > 0 ? `protocol ${protocol}, from ${low} m` : `protocol ${protocol}`;
}

/** [low, high] of an estimate, or null where it has no interval. */
export function intervalOf(estimate) {
  return estimate && estimate.low !== null && estimate.low !== undefined ? [estimate.low, estimate.high] : null;
}

/** Why an estimate has no interval: "no interval: 12 scans, expected ..."; null where it has one or no value. */
export function whyNoInterval(estimate) {
  return estimate?.no_interval ? `no interval: ${estimate.no_interval}` : null;
}
