import { element } from './dom.js';

/** What a reader must know before the numbers: simulated data, doubts, points that were left out. */
export function notices(state, content, clouds) {
  const node = element('div', { class: 'notices' });
  state.follow(['result'], () => {
    const result = state.get('result');
    const { doubts, result: header } = content.results[result];
    const simulated = header.provenance.simulated?.notice;
    const leftOut = clouds.leftOut(result);
    node.replaceChildren(
      ...[
        simulated && element('p', { class: 'notice' }, simulated),
        ...doubts.map((doubt) => element('p', { class: 'notice' }, doubt)),
        leftOut && element('p', { class: 'notice quiet' }, `${leftOut}. All numbers are of all scans.`),
      ].filter(Boolean),
    );
  });
  return node;
}
