import { Clouds } from './clouds.js';
import { element } from './dom.js';
import { header } from './header.js';
import { keyActions, listenToKeys } from './keyboard.js';
import { readContent } from './payload.js';
import { State } from './state.js';
import { preferredTheme } from './theme.js';
import { toolbar } from './toolbar.js';
import { Transport } from './transport.js';
import { Viewer } from './viewer.js';
import { worstScans } from './metrics.js';

/** The scan to begin with: the worst one whose points are in the file. */
function firstScan(content, clouds, result) {
  const drawable = clouds.scansOf(result);
  const worst = worstScans(content.results[result].result).find((k) => drawable.includes(k));
  return worst ?? drawable[0] ?? 0;
}

function initialState(content, clouds) {
  return new State({
    result: 0,
    other: null,
    scan: firstScan(content, clouds, 0),
    view: 'orbit',
    colouring: 'outcome',
    visible: [true, true, true, true, true, true],
    pointSize: 1.6,
    theme: preferredTheme(),
  });
}

function viewSection(state, content, clouds) {
  const transport = new Transport(state, content, clouds);
  const section = element('section', { class: 'view', 'aria-label': 'Points' });
  try {
    const viewer = new Viewer(state, content, clouds);
    section.append(toolbar(state, content, clouds, viewer), viewer.node, transport.node);
    return { section, viewer, transport };
  } catch (error) {
    section.append(element('p', { class: 'notice' }, `This browser cannot draw the points (${error.message}).`));
    return { section, viewer: null, transport };
  }
}

function start() {
  const content = readContent();
  const clouds = new Clouds(content);
  const state = initialState(content, clouds);
  state.follow(['theme'], () => (document.documentElement.dataset.theme = state.get('theme')));
  const { section, viewer, transport } = viewSection(state, content, clouds);
  if (viewer) listenToKeys(keyActions(state, viewer, transport));
  state.follow(['result'], () => {
    state.set({ other: null, scan: firstScan(content, clouds, state.get('result')) });
  });
  document.body.append(header(state, content), element('main', {}, section));
  globalThis.mosbenchReport = { content, state, viewer, transport };
}

performance.mark('start');
start();
performance.mark('end');
