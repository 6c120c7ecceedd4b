import { Charts } from './charts.js';
import { Clouds } from './clouds.js';
import { element } from './dom.js';
import { header } from './header.js';
import { keyActions, keyList, listenToKeys } from './keyboard.js';
import { leaderboards } from './leaderboard.js';
import { viewOf } from './link.js';
import { hasLabels, typicalScan } from './metrics.js';
import { notices } from './notices.js';
import { readContent } from './payload.js';
import { provenance } from './provenance.js';
import { State } from './state.js';
import { paperTables, resultTables, summaryTable } from './tables.js';
import { preferredTheme } from './theme.js';
import { tiles } from './tiles.js';
import { toolbar } from './toolbar.js';
import { Transport } from './transport.js';
import { Viewer } from './viewer.js';

/** The scan to begin with: a typical one of those whose points are in the file; the worst are a key away. */
function firstScan(content, clouds, result) {
  const drawable = clouds.scansOf(result).filter((k) => hasLabels(content.results[result].result.scans[k]));
  return typicalScan(content.results[result].result, drawable) ?? drawable[0] ?? 0;
}

/** Two runs of the same scans are there to be compared. */
function firstOthers(clouds, result) {
  const others = clouds.comparable(result);
  return others.length === 1 ? others : [];
}

function linkedView(content, clouds) {
  return viewOf(location.hash, content, (result) => clouds.comparable(result));
}

function initialState(content, clouds) {
  return new State({
    result: 0,
    others: firstOthers(clouds, 0),
    compared: [],
    scan: firstScan(content, clouds, 0),
    view: 'orbit',
    colouring: 'outcome',
    visible: [true, true, true, true, true, true],
    pointSize: 1.6,
    boxes: false,
    theme: preferredTheme(),
    ...linkedView(content, clouds).changes,
  });
}

/** Another result; one of the same scans shows the same scan, beside the same runs. */
function choiceOf(state, content, clouds, result) {
  const of = clouds.comparable(result);
  if (!of.includes(state.get('result'))) return { result, others: [], scan: firstScan(content, clouds, result) };
  const others = state.get('others').filter((other) => other !== result);
  return { result, others, scan: state.get('scan') };
}

/** The 3-D view with its controls; null where the browser cannot draw it. */
function makeViewer(state, content, clouds, section) {
  try {
    return new Viewer(state, content, clouds);
  } catch (error) {
    section.append(element('p', { class: 'notice' }, `This browser cannot draw the points (${error.message}).`));
    return null;
  }
}

function fillViewSection(section, state, content, clouds, transport) {
  if (content.clouds.length === 0) return null;
  const viewer = makeViewer(state, content, clouds, section);
  if (viewer) {
    const actions = keyActions(state, viewer, transport);
    listenToKeys(actions);
    const follow = () => {
      const { changes, camera } = linkedView(content, clouds);
      state.set(changes);
      if (camera) viewer.lookFrom(camera);
    };
    follow();
    globalThis.addEventListener('hashchange', follow);
    section.append(toolbar(state, content, clouds, viewer), viewer.node, transport.node, keyList(actions));
  }
  return viewer;
}

/** Resolves when all that is in the document by now has been shown. */
function shown() {
  return new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
}

async function start() {
  const content = readContent();
  const clouds = new Clouds(content);
  const state = initialState(content, clouds);
  state.follow(['theme'], () => (document.documentElement.dataset.theme = state.get('theme')));
  const transport = new Transport(state, content, clouds);
  const go = (scan) => transport.go(scan);
  const choose = (result) => state.set(choiceOf(state, content, clouds, result));
  const hasPoints = content.clouds.length > 0;
  const section = element('section', { class: hasPoints ? 'view' : '', 'aria-label': 'Points' });
  const charts = new Charts(state, content, go);
  document.body.append(
    header(state, content, choose),
    element('main', {}, notices(state, content, clouds), leaderboards(state, content, choose), tiles(state, content), section, charts.node,
      summaryTable(content, choose), resultTables(state, content, go), paperTables(content), provenance(state, content)),
  );
  // Unpacking goes on in the background; getting at the graphics card may take a second. Neither
  // keeps the numbers waiting.
  if (hasPoints) clouds.read(state.get('result'), state.get('scan'));
  await shown();
  const viewer = fillViewSection(section, state, content, clouds, transport);
  globalThis.mosbenchReport = { content, state, viewer, transport, charts };
}

start();
