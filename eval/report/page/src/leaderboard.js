import { element, table } from './dom.js';
import { fixed, intervalOf, percent, rulesText, whyNoInterval } from './format.js';

const points = (fraction) => `${fraction < 0 ? '−' : '+'}${Math.abs(100 * fraction).toFixed(1)}`;

function withHint(text, hint, title) {
  return element('span', { title }, text, hint ? element('span', { class: 'hint' }, ` ${hint}`) : null);
}

function estimateCell(metrics, metric) {
  const estimate = metrics?.[metric];
  if (!estimate) return '–';
  const ends = intervalOf(estimate);
  return withHint(percent(estimate.value), ends && `${(100 * ends[0]).toFixed(1)}–${(100 * ends[1]).toFixed(1)}`, whyNoInterval(estimate));
}

function toFirstCell(row, place) {
  if (place === 0) return row.all ? 'best' : '–';
  const { to_first: difference } = row;
  if (!difference) return '–';
  if (difference.value === null) return withHint('undefined', null, whyNoInterval(difference));
  const ends = intervalOf(difference);
  return withHint(points(difference.value), ends ? `${points(ends[0])} to ${points(ends[1])}` : 'no interval', whyNoInterval(difference));
}

const valueText = (value) => (value === null ? '–' : String(value));

function cellsOf(row, place, names, settings) {
  const sequences = names.length > 1 ? row.sequences.map(({ metrics }) => estimateCell(metrics, 'iou')) : [];
  return [
    String(place + 1), withHint(row.method, row.run, row.setting), ...settings.map((name) => valueText(row.differing_settings[name])), estimateCell(row.all, 'iou'), ...sequences,
    estimateCell(row.all, 'precision'), estimateCell(row.all, 'recall'), fixed(row.ms_per_scan, 1), fixed(row.memory_mb, 0),
    row.on_front ? element('span', { title: 'on the Pareto front' }, '★') : '', toFirstCell(row, place),
  ];
}

/** The result of a run that is of the shown sequence, else its first one. */
function resultOf({ results }, content, shown) {
  const sequenceOf = (i) => content.results[i].result.sequence;
  return results.find((i) => sequenceOf(i) === sequenceOf(shown)) ?? results[0];
}

function boardNode(board, state, content, choose) {
  const { sequences: names, differing_settings: settings, rows, remarks } = board;
  const titles = ['', 'method', ...settings, 'IoU', ...(names.length > 1 ? names : []), 'precision', 'recall', 'ms/scan', 'MB', 'front', 'IoU to the best'];
  const body = table(titles, rows.map((row, place) => cellsOf(row, place, names, settings)), {
    leftColumns: 2, onRow: (r) => choose(resultOf(rows[r], content, state.get('result'))),
  });
  const lines = body.querySelectorAll('tbody tr');
  state.follow(['result'], () => lines.forEach((line, r) => {
    if (rows[r].results.includes(state.get('result'))) line.setAttribute('aria-current', 'true');
    else line.removeAttribute('aria-current');
  }));
  return element('section', { class: 'block leaderboard' }, element('h2', {}, 'Leaderboard'),
    element('p', { class: 'hint' }, `Data set ${board.dataset}, ${rulesText(board)}. ★: no other run is as good and as fast, and better in one. Last column: paired difference in percentage points, with its 95 % interval. A click on a row shows the run.`),
    body, element('ul', { class: 'hint' }, ...remarks.map((remark) => element('li', {}, remark))));
}

/** A ranking for each group of runs on the same scans. */
export function leaderboards(state, content, choose) {
  return element('div', { class: 'boards' }, ...(content.leaderboards ?? []).map((board) => boardNode(board, state, content, choose)));
}
