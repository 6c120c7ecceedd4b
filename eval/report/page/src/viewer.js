import { colourScans, sizePoints } from './colouring.js';
import { element } from './dom.js';
import { Legend } from './legend.js';
import { join, movingPoints } from './motion_map.js';
import { pick } from './picking.js';
import { pointDetails } from './point_details.js';
import { Scale } from './scale.js';
import { Stage } from './stage.js';
import { surface } from './theme.js';
import { viewpoint } from './views.js';

const CLICK_PIXELS = 4;

/** The 3-D view: shows the state's scan of one result, or of two side by side. */
export class Viewer {
  node = element('div', { class: 'stage' });
  scans = [];
  #turn = 0;
  #maps = new Map();

  constructor(state, content, clouds) {
    Object.assign(this, { state, content, clouds });
    const canvas = element('canvas', { tabindex: '0', 'aria-label': 'Points of the scan in 3-D' });
    this.names = [0, 1].map(() => element('span', { class: 'pane-name' }));
    this.legend = new Legend(state);
    this.scale = new Scale();
    this.details = element('div', { class: 'details', hidden: true, 'aria-live': 'polite' });
    this.busy = element('span', { class: 'busy', role: 'status' });
    this.node.append(canvas, ...this.names, this.busy, this.legend.node, this.scale.node, this.details);
    this.stage = new Stage(canvas);
    this.#listen(canvas);
    state.follow(['theme'], () => this.stage.setTheme(surface(state.get('theme'))));
    state.follow(['result', 'other', 'scan', 'view'], () => this.show());
    state.follow(['theme', 'colouring', 'visible', 'pointSize'], () => this.#paint());
  }

  /** Results in the panes, left to right. */
  results() {
    const other = this.state.get('other');
    return other === null ? [this.state.get('result')] : [this.state.get('result'), other];
  }

  async show() {
    const turn = ++this.#turn;
    const [results, scan, view] = [this.results(), this.state.get('scan'), this.state.get('view')];
    const scans = await Promise.all(results.map((r) => (view === 'map' ? this.#motionMap(r) : this.clouds.read(r, scan))));
    if (turn !== this.#turn || scans.includes(null)) return; // another scan was asked for meanwhile
    this.scans = scans;
    this.details.hidden = true;
    this.stage.shown = scans.length;
    this.names.forEach((name, p) => {
      name.textContent = scans.length > 1 ? this.content.results[results[p]].run : '';
      name.style.left = `${p * 50}%`;
    });
    this.node.classList.toggle('two', scans.length > 1);
    this.legend.fill(scans);
    this.#paint();
    this.#look(view);
    this.node.dataset.shown = `${view === 'map' ? 'map' : scan} ${results.join(' ')}`;
  }

  /** The map is of one place for all runs: the first scan's. */
  async #motionMap(result) {
    if (!this.#maps.has(result)) {
      const indices = this.clouds.scansOf(result);
      const parts = [];
      let origin = null;
      for (const k of indices) {
        const scan = await this.clouds.read(result, k);
        origin ??= [3, 7, 11].map((i) => scan.pose[i]);
        parts.push(movingPoints(scan, origin));
        this.busy.textContent = `adding up scan ${parts.length} of ${indices.length}`;
      }
      this.busy.textContent = '';
      this.#maps.set(result, join(parts));
    }
    return this.#maps.get(result);
  }

  #look(view) {
    if (this.look === view) return this.stage.draw();
    this.look = view;
    this.stage.look(viewpoint(view, this.scans[0]));
  }

  /** Back to where the view starts. */
  resetView() {
    this.look = null;
    this.#look(this.state.get('view'));
  }

  #paint() {
    const [key, theme] = [this.state.get('colouring'), this.state.get('theme')];
    const { colours, scale } = colourScans(key, this.scans, theme);
    this.scans.forEach((scan, p) => {
      const sizes = sizePoints(scan, this.state.get('visible'), this.state.get('pointSize'));
      this.stage.panes[p].fill(scan.positions_m, colours[p], sizes, scan.path ?? null);
    });
    this.scale.fill(key, scale, theme, this.#thresholds());
    this.stage.draw();
  }

  /** Of the scans in the panes; the motion map has none. */
  #thresholds() {
    if (this.state.get('view') === 'map') return [];
    return this.results().map((r) => this.content.results[r].result.scans[this.state.get('scan')].threshold);
  }

  #listen(canvas) {
    let down = null;
    canvas.addEventListener('pointerdown', (event) => (down = [event.clientX, event.clientY]));
    canvas.addEventListener('pointerup', (event) => {
      if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > CLICK_PIXELS) return;
      const box = canvas.getBoundingClientRect();
      this.pickAt(event.clientX - box.left, event.clientY - box.top);
    });
    canvas.addEventListener('wheel', (event) => this.#zoomSensorView(event), { passive: false });
  }

  #zoomSensorView(event) {
    if (this.state.get('view') !== 'sensor') return;
    event.preventDefault();
    const { camera } = this.stage;
    camera.fov = Math.min(100, Math.max(15, camera.fov * Math.exp(event.deltaY / 1000)));
    this.stage.draw();
  }

  /** Shows the numbers of the point at these pixels of the canvas, or none. */
  pickAt(x, y) {
    if (this.scans.length === 0) return;
    const { width, height } = this.stage.paneSize();
    const pane = Math.min(Math.floor(x / width), this.scans.length - 1);
    const { geometry } = this.stage.panes[pane];
    const at = { x: x - pane * width, y, width, height };
    const point = pick(this.scans[pane].positions_m, geometry.getAttribute('size').array, this.stage.clipMatrix(), at);
    this.details.hidden = point < 0;
    if (point < 0) return;
    const runs = this.results().map((r) => this.content.results[r].run);
    this.details.replaceChildren(pointDetails(this.scans, pane, point, runs));
  }

  /** Points per colour as the graphics card gets them, "r,g,b" to number. */
  coloursShown(pane = 0) {
    const shades = this.stage.panes[pane].geometry.getAttribute('shade').array;
    const counts = {};
    for (let i = 0; i < shades.length; i += 3) {
      const colour = `${shades[i]},${shades[i + 1]},${shades[i + 2]}`;
      counts[colour] = (counts[colour] ?? 0) + 1;
    }
    return counts;
  }
}
