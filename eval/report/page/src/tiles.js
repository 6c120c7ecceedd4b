import { element } from './dom.js';
import { count, fixed, intervalOf, percent, whyNoInterval } from './format.js';
import { runNames } from './runs_menu.js';

function tile(name, value, note) {
  return element('div', { class: 'tile' }, element('span', { class: 'tile-name' }, name), element('span', { class: 'tile-value' }, value),
    note ? element('span', { class: 'hint' }, note) : null);
}

function interval(estimate) {
  const ends = intervalOf(estimate);
  return ends ? `95 %: ${(100 * ends[0]).toFixed(1)} to ${percent(ends[1])}` : whyNoInterval(estimate);
}

/** What is told of a run: [{name, value, note}]. */
function numbersOf({ result, estimates }) {
  const { summary, timing, scans } = result;
  const judged = summary
    ? [
        { name: 'IoU', value: percent(summary.iou), note: interval(estimates?.iou) ?? `benchmark's rounding: ${summary.published_text}` },
        { name: 'precision', value: percent(summary.precision), note: interval(estimates?.precision) ?? `${count(summary.fp)} false positives` },
        { name: 'recall', value: percent(summary.recall), note: interval(estimates?.recall) ?? `${count(summary.fn)} false negatives` },
      ]
    : [{ name: 'truth', value: 'none', note: 'labels only' }];
  const ms = timing?.method_ms_per_scan;
  const cost = ms === null || ms === undefined ? [] : [{ name: 'per scan', value: fixed(ms, 1, 'ms'), note: `${fixed(1000 / ms, 1)} scans a second, ${timing.threads} threads` }];
  return [...judged, ...cost, { name: 'scans', value: count(scans.length), note: summary ? `${count(summary.labelled_scans)} with truth` : null }];
}

/** A number of every run that is shown, the first one's first. */
function tileOfSeveral(name, runs) {
  const lines = runs.map(({ run, numbers }) => {
    const { value = '–', note = null } = numbers.find((number) => number.name === name) ?? {};
    return [element('dt', {}, run), element('dd', { title: note }, value)];
  });
  return element('div', { class: 'tile' }, element('span', { class: 'tile-name' }, name), element('dl', { class: 'tile-runs' }, ...lines.flat()));
}

/** The numbers one asks for first, of every run that is shown. */
export function tiles(state, content) {
  const node = element('section', { class: 'tiles', 'aria-label': 'Summary' });
  state.follow(['result', 'others'], () => {
    const entries = [state.get('result'), ...state.get('others')].map((r) => content.results[r]);
    const names = runNames(entries);
    const runs = entries.map((entry, i) => ({ run: names[i], numbers: numbersOf(entry) }));
    const asked = [...new Set(runs.flatMap(({ numbers }) => numbers.map(({ name }) => name)))];
    node.replaceChildren(...(runs.length === 1
      ? runs[0].numbers.map(({ name, value, note }) => tile(name, value, note))
      : asked.map((name) => tileOfSeveral(name, runs))));
  });
  return node;
}
