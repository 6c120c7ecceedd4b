import { COLOURINGS } from './colouring.js';
import { element } from './dom.js';
import { VIEWS } from './views.js';

function choice(label, options, selected, change) {
  const select = element('select', { 'aria-label': label, onchange: () => change(select.value) });
  select.append(...options.map(({ key, name }) => element('option', { value: key, selected: key === selected }, name)));
  return element('label', { class: 'choice' }, label, select);
}

function viewButtons(state) {
  const group = element('div', { class: 'segments', role: 'group', 'aria-label': 'View' });
  const buttons = VIEWS.map(({ key, name }, i) =>
    element('button', { type: 'button', 'data-view': key, title: `${name} view (${i + 1})`, onclick: () => state.set({ view: key }) }, name));
  group.append(...buttons);
  state.follow(['view'], () =>
    buttons.forEach((button) => button.setAttribute('aria-pressed', String(button.dataset.view === state.get('view')))));
  return group;
}

/** What to look at and how. */
export function toolbar(state, content, clouds, viewer) {
  const compare = element('span', {});
  const colours = element('span', {});
  state.follow(['result', 'other'], () => {
    const others = clouds.comparable(state.get('result'));
    const options = [{ key: '', name: 'nothing' }, ...others.map((i) => ({ key: i, name: content.results[i].run }))];
    compare.replaceChildren(...(others.length === 0 ? [] : [choice('beside', options, state.get('other') ?? '', (value) =>
      state.set({ other: value === '' ? null : Number(value) }))]));
  });
  state.follow(['colouring'], () =>
    colours.replaceChildren(choice('colour', COLOURINGS, state.get('colouring'), (value) => state.set({ colouring: value }))));
  const sizes = [{ key: 1, name: 'small' }, { key: 1.6, name: 'medium' }, { key: 2.6, name: 'large' }];
  return element('div', { class: 'toolbar' }, viewButtons(state), colours,
    choice('points', sizes, state.get('pointSize'), (value) => state.set({ pointSize: Number(value) })), compare,
    element('button', { type: 'button', title: 'Back to where the view starts (r)', onclick: () => viewer.resetView() }, 'reset'));
}
