import { choice } from './choice.js';
import { allColourings } from './colouring.js';
import { element } from './dom.js';
import { hashOf } from './link.js';
import { runOptions, RunsMenu } from './runs_menu.js';
import { fileName, save } from './saving.js';
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

/** What to colour by; what cannot be shown says why. */
function colourChoice(state, clouds, viewer) {
  const node = element('span', {});
  state.follow(['result', 'others', 'colouring', 'view'], () => {
    const all = allColourings(clouds, viewer.results(), state.get('view'));
    if (!all.some(({ key, why }) => why === null && key === state.get('colouring'))) return state.set({ colouring: 'outcome' });
    const options = all.map(({ key, name, why }) => ({ key, name: why === null ? name : `${name}: ${why}`, disabled: why !== null }));
    node.replaceChildren(choice('colour', options, state.get('colouring'), (value) => state.set({ colouring: value })));
  });
  return node;
}

/** Up to five runs of the same scans beside the chosen one. */
function besideChoice(state, content, clouds) {
  const menu = new RunsMenu('beside', (others) => state.set({ others }));
  state.follow(['result', 'others'], () => {
    const others = clouds.comparable(state.get('result'));
    menu.fill(runOptions(content, state.get('result'), others), state.get('others'));
  });
  return menu.node;
}

const PICTURE_RATIO = 2;

/** Saves the picture, and puts a link to the view where it can be copied. */
function keepButtons(state, content, viewer) {
  const message = element('span', { class: 'hint', role: 'status' });
  const picture = async () => {
    const { run, result } = content.results[state.get('result')];
    const png = await viewer.picture(PICTURE_RATIO);
    const what = state.get('view') === 'map' ? 'map' : (result.scans[state.get('scan')]?.stem ?? '');
    save(png, fileName([run, result.sequence, what, state.get('view')], 'png'));
  };
  const link = async () => {
    location.replace(hashOf(state, viewer.stage.camera_m()));
    const copied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
    message.textContent = copied ? 'link copied' : 'the address holds the link';
  };
  state.follow(['result', 'others', 'scan', 'view'], () => (message.textContent = ''));
  return [
    element('button', { type: 'button', title: 'Save as PNG, twice as large, without background', onclick: picture }, 'save picture'),
    element('button', { type: 'button', title: 'A link to this scan and view', onclick: link }, 'copy link'), message,
  ];
}

/** Boxes around what moves, where the file has some. */
function boxesButton(state, content) {
  if (!content.results.some(({ boxes }) => boxes?.some((ofScan) => ofScan.length > 0))) return null;
  const button = element('button', { type: 'button', title: 'Boxes around clusters of points that are labelled moving, with their speeds', onclick: () => state.set({ boxes: !state.get('boxes') }) }, 'boxes');
  state.follow(['boxes'], () => button.setAttribute('aria-pressed', String(state.get('boxes'))));
  return button;
}

/** What to look at and how. */
export function toolbar(state, content, clouds, viewer) {
  const sizes = [{ key: 1, name: 'small' }, { key: 1.6, name: 'medium' }, { key: 2.6, name: 'large' }];
  return element('div', { class: 'toolbar' }, viewButtons(state), colourChoice(state, clouds, viewer),
    choice('points', sizes, state.get('pointSize'), (value) => state.set({ pointSize: Number(value) })), besideChoice(state, content, clouds), boxesButton(state, content),
    element('button', { type: 'button', title: 'Back to where the view starts (r)', onclick: () => viewer.resetView() }, 'reset'), ...keepButtons(state, content, viewer));
}
