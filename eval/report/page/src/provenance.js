import { element, table } from './dom.js';
import { resultName } from './header.js';

const NOT_PROVENANCE = new Set(['scans', 'summary', 'timing', 'remarks', 'doubts', 'scans_without_detection', 'splits', 'places', 'doubtful_poses']);

/** [["settings.voxel_size_m", "0.25"], ...] of nested objects. */
export function flatten(value, prefix = '') {
  if (value === null || typeof value !== 'object' || Array.isArray(value)) {
    return [[prefix, typeof value === 'string' ? value : JSON.stringify(value)]];
  }
  return Object.entries(value).flatMap(([key, inner]) => flatten(inner, prefix ? `${prefix}.${key}` : key));
}

function factsOf({ folder, protocol_summary: rules, result }) {
  const kept = Object.fromEntries(Object.entries(result).filter(([key]) => !NOT_PROVENANCE.has(key)));
  const { timing = {}, places = {} } = result;
  const facts = [['results in', folder], ['data set at', places.dataset_root], ['labels from', places.predictions?.path], ['rules', rules], ...flatten(kept), ['threads', timing.threads], ['wall_s', timing.wall_s]];
  return new Map(facts.filter(([, value]) => value !== undefined).map(([key, value]) => [key, String(value)]));
}

/** What each number of the report comes from; what differs between runs stands out. */
export function provenance(state, content) {
  const node = element('section', { class: 'block provenance' });
  state.follow(['result', 'others'], () => {
    const shown = [state.get('result'), ...state.get('others')].map((r) => content.results[r]);
    const facts = shown.map(factsOf);
    const keys = [...new Set(facts.flatMap((f) => [...f.keys()]))];
    const rows = keys.map((key) => {
      const values = facts.map((f) => f.get(key) ?? '');
      const differs = values.some((value) => value !== values[0]);
      return [key, ...values.map((value) => element(differs ? 'strong' : 'span', {}, value))];
    });
    const remarks = shown[0].result.remarks ?? [];
    node.replaceChildren(
      element('h2', {}, 'Where this comes from'),
      element('ul', { class: 'hint' }, ...remarks.map((remark) => element('li', {}, remark))),
      table(['', ...shown.map(resultName)], rows, { leftColumns: 1 + shown.length }),
      element('p', { class: 'hint' }, `Page and numbers by mosbench ${content.version}; drawn with three.js and uPlot, whose licences are in this file.`),
    );
  });
  return node;
}
