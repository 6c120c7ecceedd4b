import { element } from './dom.js';
import { count, fixed, intervalOf, percent, whyNoInterval } from './format.js';

function tile(name, value, note) {
  return element('div', { class: 'tile' }, element('span', { class: 'tile-name' }, name), element('span', { class: 'tile-value' }, value),
    note ? element('span', { class: 'hint' }, note) : null);
}

function interval(estimate) {
  const ends = intervalOf(estimate);
  return ends ? `95 %: ${(100 * ends[0]).toFixed(1)} to ${percent(ends[1])}` : whyNoInterval(estimate);
}

/** The numbers one asks for first. */
export function tiles(state, content) {
  const node = element('section', { class: 'tiles', 'aria-label': 'Summary' });
  state.follow(['result'], () => {
    const { result, estimates } = content.results[state.get('result')];
    const { summary, timing, scans } = result;
    const judged = summary
      ? [
          tile('IoU', percent(summary.iou), interval(estimates?.iou) ?? `benchmark's rounding: ${summary.published_text}`),
          tile('precision', percent(summary.precision), interval(estimates?.precision) ?? `${count(summary.fp)} false positives`),
          tile('recall', percent(summary.recall), interval(estimates?.recall) ?? `${count(summary.fn)} false negatives`),
        ]
      : [tile('truth', 'none', 'labels only')];
    const ms = timing?.method_ms_per_scan;
    const cost = ms === null || ms === undefined ? [] : [tile('per scan', fixed(ms, 1, 'ms'), `${fixed(1000 / ms, 1)} scans a second, ${timing.threads} threads`)];
    node.replaceChildren(...judged, ...cost, tile('scans', count(scans.length), summary ? `${count(summary.labelled_scans)} with truth` : null));
  });
  return node;
}
