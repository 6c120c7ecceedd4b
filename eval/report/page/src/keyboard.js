import { colouringsOf } from './colouring.js';
import { element } from './dom.js';
import { VIEWS } from './views.js';

function next(list, key) {
  return list[(list.findIndex((item) => item.key === key) + 1) % list.length].key;
}

/** What each key does, and the sentence that says so. */
export function keyActions(state, viewer, transport) {
  const view = (i) => () => state.set({ view: VIEWS[i].key });
  return {
    ArrowLeft: ['← →', 'previous and next scan', () => transport.step(-1)],
    ArrowRight: [null, null, () => transport.step(1)],
    ' ': ['space', 'play and pause', () => transport.toggle()],
    Home: ['home end', 'first and last scan', () => transport.edge(false)],
    End: [null, null, () => transport.edge(true)],
    w: ['w', 'next worse scan', () => transport.nextWorst()],
    1: ['1 2 3 4', 'orbit, top, sensor view, motion map', view(0)],
    2: [null, null, view(1)],
    3: [null, null, view(2)],
    4: [null, null, view(3)],
    c: ['c', 'colour by the next quantity', () => state.set({ colouring: next(colouringsOf(viewer.clouds, viewer.results(), state.get('view')), state.get('colouring')) })],
    b: ['b', 'boxes of what moves', () => state.set({ boxes: !state.get('boxes') })],
    r: ['r', 'view back to its start', () => viewer.resetView()],
    t: ['t', 'light or dark', () => state.set({ theme: state.get('theme') === 'dark' ? 'light' : 'dark' })],
  };
}

/** Keys work everywhere but where something is typed or chosen. */
export function listenToKeys(actions) {
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest('select, input:not([type=range]), textarea')) return;
    const onControl = event.target.closest('button, tr, summary');
    if (onControl && event.key === ' ') return;
    const action = actions[event.key]?.[2];
    if (!action) return;
    event.preventDefault();
    action();
  });
}

/** The keys for readers, folded away. */
export function keyList(actions) {
  const named = Object.values(actions).filter(([keys]) => keys);
  return element('details', { class: 'keys hint' }, element('summary', {}, 'Keys'),
    element('dl', {}, ...named.flatMap(([keys, what]) => [element('dt', {}, element('kbd', {}, keys)), element('dd', {}, what)])));
}
