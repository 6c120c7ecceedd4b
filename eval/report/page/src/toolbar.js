import { choice } from './choice.js';
import { COLOURINGS, colouringsOf } from './colouring.js';
import { element } from './dom.js';
import { VIEWS } from './views.js';

function viewButtons(state) {
  const group = element('div', { class: 'segments', role: 'group', 'aria-label': 'View' });
  const buttons = VIEWS.map(({ key, name }, i) =>
    element('button', { type: 'button', 'data-view': key, title: `${name} view (${i + 1})`, onclick: () => state.set({ view: key }) }, name));
  group.append(...buttons);
  state.follow(['view'], () =>
    buttons.forEach((button) => button.setAttribute('aria-pressed', String(button.dataset.view === state.get('view')))));
  return group;
}

/** What to colour by; what needs other runs is named with the command that gives them. */
function colourChoice(state, clouds, viewer) {
  const node = element('span', {});
  state.follow(['result', 'other', 'colouring'], () => {
    const offered = colouringsOf(clouds, viewer.results());
    if (!offered.some(({ key }) => key === state.get('colouring'))) return state.set({ colouring: 'outcome' });
    const missing = COLOURINGS.filter((colouring) => !offered.includes(colouring));
    const options = [...offered, ...missing.map(({ key, name }) => ({ key, name: `${name}: needs mosbench run --scores`, disabled: true }))];
    node.replaceChildren(choice('colour', options, state.get('colouring'), (value) => state.set({ colouring: value })));
  });
  return node;
}

/** What to look at and how. */
export function toolbar(state, content, clouds, viewer) {
  const compare = element('span', {});
  state.follow(['result', 'other'], () => {
    const others = clouds.comparable(state.get('result'));
    const options = [{ key: '', name: 'nothing' }, ...others.map((i) => ({ key: i, name: content.results[i].run }))];
    compare.replaceChildren(...(others.length === 0 ? [] : [choice('beside', options, state.get('other') ?? '', (value) =>
      state.set({ other: value === '' ? null : Number(value) }))]));
  });
  const sizes = [{ key: 1, name: 'small' }, { key: 1.6, name: 'medium' }, { key: 2.6, name: 'large' }];
  return element('div', { class: 'toolbar' }, viewButtons(state), colourChoice(state, clouds, viewer),
    choice('points', sizes, state.get('pointSize'), (value) => state.set({ pointSize: Number(value) })), compare,
    element('button', { type: 'button', title: 'Back to where the view starts (r)', onclick: () => viewer.resetView() }, 'reset'));
}
