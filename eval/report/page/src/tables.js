import { block, element, table } from './dom.js';
import { count, fixed, intervalOf, percent, whyNoInterval } from './format.js';
import { iou, worstScans } from './metrics.js';

const AT_MOST = 12;

function withInterval(value, estimate) {
  const ends = intervalOf(estimate);
  const why = whyNoInterval(estimate);
  if (why) return element('span', { title: why }, percent(value), element('span', { class: 'hint' }, ' no interval'));
  if (!ends) return percent(value);
  return element('span', {}, percent(value), element('span', { class: 'hint' }, ` ${(100 * ends[0]).toFixed(1)}–${(100 * ends[1]).toFixed(1)}`));
}

/** A row per result; a click looks at it. */
export function summaryTable(content, choose) {
  const rows = content.results.map(({ run, result, estimates }) => {
    const s = result.summary;
    const judged = s
      ? [withInterval(s.iou, estimates?.iou), withInterval(s.precision, estimates?.precision), withInterval(s.recall, estimates?.recall), percent(s.f1), count(s.tp), count(s.fp), count(s.fn), s.published_text]
      : ['no truth', '', '', '', '', '', '', ''];
    return [run, result.sequence, result.protocol.name, [result.method?.name, result.settings?.variant].filter(Boolean).join(', '), count(result.scans.length), ...judged, fixed(result.timing?.method_ms_per_scan, 1)];
  });
  const titles = ['run', 'sequence', 'protocol', 'method', 'scans', 'IoU', 'precision', 'recall', 'F1', 'TP', 'FP', 'FN', "benchmark's rounding", 'ms/scan'];
  return block('Results', content.results.length > 1 ? 'A click on a row shows it above.' : null, table(titles, rows, { leftColumns: 4, onRow: choose }));
}

export function worstScansTable(entry, go) {
  const { scans } = entry.result;
  const worst = worstScans(entry.result).slice(0, AT_MOST);
  if (worst.length === 0) return null;
  const rows = worst.map((k) => [scans[k].stem, count(scans[k].fp), count(scans[k].fn), count(scans[k].tp), percent(iou(scans[k]))]);
  return block('Worst scans', 'Most false points first; scans before the method looks for motion come last.', table(['scan', 'FP', 'FN', 'TP', 'IoU'], rows, { onRow: (r) => go(worst[r]) }));
}

const place = (position) => position.map((m) => m.toFixed(1)).join(', ');

function scanIndex(entry, stem) {
  return entry.result.scans.findIndex((scan) => scan.stem === stem);
}

export function falseClustersTable(entry, go) {
  const clusters = entry.breakdown?.false_positive_clusters?.slice(0, AT_MOST) ?? [];
  if (clusters.length === 0) return null;
  const rows = clusters.map((c) => [c.scan, count(c.points), fixed(c.range_m, 1), fixed(c.size_m, 1), place(c.position_map_m)]);
  return block('Worst false positives', 'Clusters of points called moving that are not.', table(['scan', 'points', 'range m', 'size m', 'position in the map m'], rows, { onRow: (r) => go(scanIndex(entry, clusters[r].scan)) }));
}

export function missedObjectsTable(entry, go) {
  const objects = entry.breakdown?.objects?.filter((o) => o.tp < o.points).slice(0, AT_MOST) ?? [];
  if (objects.length === 0) return null;
  const rows = objects.map((o) => [o.first_scan, count(o.sightings), count(o.points), percent(o.recall), fixed(o.mean_range_m, 1), fixed(o.largest_size_m, 1), fixed(o.speed_m_s, 1), o.detection_delay_scans === null ? 'never' : count(o.detection_delay_scans)]);
  const clock = entry.breakdown.speed_clock === 'stamps' ? 'by the scans’ stamps' : 'as if scans came at 10 Hz';
  return block('Worst objects', `Moving objects by the points that were missed; speeds in the map’s frame, ${clock}.`, table(['first scan', 'scans', 'points', 'recall', 'range m', 'size m', 'm/s', 'found after scans'], rows, { onRow: (r) => go(scanIndex(entry, objects[r].first_scan)) }));
}

/** The same labels by the rules of every protocol. */
export function protocolsTable(entry) {
  const rows = entry.protocols ?? [];
  if (rows.length === 0) return null;
  const own = entry.result.protocol.name;
  const cells = rows.map(({ name, iou: value, published_text: text, tp, fp, fn, why }) => [
    element(name === own ? 'strong' : 'span', {}, name), percent(value), text, count(tp), count(fp), count(fn), element('span', { class: 'why' }, why),
  ]);
  return block('By every protocol', 'The same labels, counted by the rules of each benchmark. The run was scored by the one in bold.', table(['protocol', 'IoU', "benchmark's rounding", 'TP', 'FP', 'FN', 'why'], cells));
}

function paperCell({ published_percent: published, measured, low, high, no_interval: noInterval, verdict, reasons }) {
  if (measured === null || measured === undefined) return published || '–';
  const missing = noInterval ? ' [no interval]' : '';
  const interval = low === null ? missing : ` [${(100 * low).toFixed(1)}, ${(100 * high).toFixed(1)}]`;
  return element('span', { title: (reasons ?? []).join('; ') }, published ? `${published} / ` : '', element('strong', {}, `${(100 * measured).toFixed(1)}${interval}`), element('span', { class: 'hint' }, ` ${verdict}`));
}

/** Published tables with what these results put beside them; apart from them what does not compare. */
export function paperTables(content) {
  const shown = (content.tables ?? []).flatMap(({ title, averaging, columns, rows }) => [false, true].map((isApart) => {
    const chosen = rows.filter(({ apart }) => Boolean(apart) === isApart);
    if (chosen.length === 0) return null;
    const why = ({ cells }) => [...new Set(cells.flatMap(({ reasons }) => reasons ?? []))].join('; ');
    const lines = chosen.map((row) => [row.method, row.setting, ...row.cells.map(paperCell), ...(isApart ? [why(row)] : [])]);
    return block(isApart ? `${title}: not comparable` : title, `IoU in percent, ${isApart ? 'measured' : 'published / measured'} [95 % interval]; ${averaging}`,
      table(['method', 'setting', ...columns, ...(isApart ? ['why not comparable'] : [])], lines, { leftColumns: 2 }));
  }));
  return element('div', { class: 'paper' }, ...shown.filter(Boolean));
}

/** Everything about the chosen result. */
export function resultTables(state, content, go) {
  const node = element('div', { class: 'blocks' });
  state.follow(['result'], () => {
    const entry = content.results[state.get('result')];
    const tables = [worstScansTable(entry, go), falseClustersTable(entry, go), missedObjectsTable(entry, go), protocolsTable(entry)];
    node.replaceChildren(...tables.filter(Boolean));
  });
  return node;
}
