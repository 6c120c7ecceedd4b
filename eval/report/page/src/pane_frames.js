import { countDisputed } from './disagreement.js';
import { countOutcomes } from './colouring.js';
import { element } from './dom.js';
import { count } from './format.js';

/** What of a pane the legend has no room for, beside more than one other. */
function noteOf(scan, opinions, pane) {
  if (opinions) {
    const { first, other } = countDisputed(opinions);
    return pane === 0 ? `${count(first + other)} disputed by any` : `${count(first)} only in the first, ${count(other)} only here`;
  }
  if (scan.unscored) return 'not scored';
  const [tp, fp, fn] = countOutcomes(scan.outcomes);
  return `TP ${count(tp)} · FP ${count(fp)} · FN ${count(fn)}`;
}

/** The names of the runs over their panes, and the lines between these. */
export class PaneFrames {
  node = element('div', { class: 'panes' });

  /** `columns` of panes; one alone needs no name. */
  fill(columns, names, scans, opinions) {
    this.node.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
    this.node.replaceChildren(...names.map((name, p) => element('div', { class: 'pane' },
      names.length > 1 ? element('span', { class: 'pane-name' }, name) : null,
      names.length > 2 || scans[p].unscored ? element('span', { class: 'pane-note' }, noteOf(scans[p], opinions?.[p], p)) : null)));
  }
}
