import { colourScans, reasonNames, sizePoints } from './colouring.js';
import { opinionNames } from './disagreement.js';
import { element } from './dom.js';
import { Legend } from './legend.js';
import { join, movingPoints, StillPoints } from './motion_map.js';
import { PaneFrames } from './pane_frames.js';
import { pick } from './picking.js';
import { pointDetails } from './point_details.js';
import { runNames } from './runs_menu.js';
import { Scale } from './scale.js';
import { SpeedLabels } from './speed_labels.js';
import { Stage } from './stage.js';
import { surface } from './theme.js';
import { viewpoint } from './views.js';

const CLICK_PIXELS = 4;

/** The 3-D view: shows the state's scan of one result, or of up to six side by side. */
export class Viewer {
  node = element('div', { class: 'stage' });
  scans = [];
  #shown = []; // the results that they are of: others may be on their way
  #turn = 0;
  #maps = new Map();

  constructor(state, content, clouds) {
    Object.assign(this, { state, content, clouds });
    const canvas = element('canvas', { tabindex: '0', 'aria-label': 'Points of the scan in 3-D' });
    this.frames = new PaneFrames();
    this.legend = new Legend(state);
    this.scale = new Scale();
    this.details = element('div', { class: 'details', hidden: true, 'aria-live': 'polite' });
    this.busy = element('span', { class: 'busy', role: 'status' });
    this.stage = new Stage(canvas);
    this.speeds = new SpeedLabels(this.stage);
    this.node.append(element('div', { class: 'screen' }, canvas, this.speeds.node, this.frames.node), this.busy, this.legend.node, this.scale.node, this.details);
    this.#listen(canvas);
    state.follow(['theme'], () => this.stage.setTheme(surface(state.get('theme'))));
    state.follow(['result', 'others', 'scan', 'view'], () => this.show());
    state.follow(['theme', 'colouring', 'visible', 'pointSize'], () => this.#paint());
    state.follow(['boxes'], () => this.#surround());
  }

  /** Results in the panes, row by row. */
  results() {
    return [this.state.get('result'), ...this.state.get('others')];
  }

  names() {
    return runNames(this.#shown.map((r) => this.content.results[r]));
  }

  async show() {
    const turn = ++this.#turn;
    this.busy.textContent = '';
    const [results, scan, view] = [this.results(), this.state.get('scan'), this.state.get('view')];
    const scans = await Promise.all(results.map((r) => (view === 'map' ? this.#motionMap(r, turn) : this.clouds.read(r, scan))));
    if (turn !== this.#turn) return; // another scan was asked for meanwhile
    this.scans = scans.includes(null) ? [] : scans; // a run without points in the file
    this.#shown = scans.includes(null) ? [] : results;
    this.details.hidden = true;
    this.stage.show(this.scans.length);
    this.node.dataset.rows = this.stage.grid().rows;
    this.node.dataset.panes = this.scans.length;
    this.legend.fill(this.scans);
    this.#surround();
    this.#paint();
    if (this.scans.length > 0) this.#look(view);
    this.node.dataset.shown = `${view === 'map' ? 'map' : scan} ${results.join(' ')}`;
  }

  /** The map is of one place for all runs: the first scan's. */
  async #motionMap(result, turn) {
    if (this.clouds.scansOf(result).length === 0) return null;
    if (!this.#maps.has(result)) {
      const indices = this.clouds.scansOf(result);
      const parts = [];
      const still = new StillPoints();
      let origin = null;
      for (const k of indices) {
        const scan = await this.clouds.read(result, k);
        if (turn !== this.#turn) return null; // something else is looked at by now
        origin ??= [3, 7, 11].map((i) => scan.pose[i]);
        parts.push(movingPoints(scan, origin));
        still.add(scan, origin);
        this.busy.textContent = `adding up scan ${parts.length} of ${indices.length}`;
      }
      this.busy.textContent = '';
      this.#maps.set(result, { ...join(parts), context: still.positions_m() });
    }
    return this.#maps.get(result);
  }

  #look(view) {
    if (this.look === view) return this.stage.draw();
    this.look = view;
    this.stage.look({ ...viewpoint(view, this.scans[0]), ...this.camera });
    this.camera = null;
  }

  /** Looks from {eye, target}, metres, when the next scan is shown, or now. */
  lookFrom(camera) {
    Object.assign(this, { camera, look: null });
    if (this.scans.length > 0) this.#look(this.state.get('view'));
  }

  /** A PNG of what is shown with the speeds of boxes, as Stage.picture has it. */
  picture(ratio) {
    const picture = this.stage.picture(ratio);
    this.speeds.draw(picture, ratio);
    return new Promise((done) => picture.toBlob(done, 'image/png'));
  }

  /** Back to where the view starts. */
  resetView() {
    this.look = null;
    this.#look(this.state.get('view'));
  }

  #paint() {
    const [wanted, theme] = [this.state.get('colouring'), this.state.get('theme')];
    const needed = { score: 'scores', reason: 'reasons', velocity: 'velocities_m_s' }[wanted];
    const key = needed && this.scans.some((scan) => !scan[needed]) ? 'outcome' : wanted;
    const { colours, scale, opinions, large } = colourScans(key, this.scans, theme);
    this.scans.forEach((scan, p) => {
      const sizes = sizePoints(scan, this.state.get('visible'), this.state.get('pointSize'), (i) => large(p, i));
      this.stage.panes[p].fill(scan.positions_m, colours[p], sizes, scan.path ?? null, scan.context ?? null);
    });
    const names = this.names();
    this.frames.fill(this.stage.grid().columns, names, this.scans, opinions);
    const name = key === 'score' ? this.clouds.scoreName(this.#shown[0] ?? this.state.get('result')) : key;
    this.scale.fill(key, scale, theme, { name, thresholds: this.#thresholds() });
    if (opinions && names.length > 1) this.scale.fillKinds(opinionNames(names, theme));
    if (key === 'reason') this.scale.fillKinds(reasonNames(theme));
    this.stage.draw();
  }

  /** The motion map, which is of many scans, has no boxes. */
  #surround() {
    const shown = this.state.get('boxes');
    const boxes = this.scans.map((scan) => (shown && scan.boxes) || []);
    boxes.forEach((ofPane, p) => this.stage.panes[p].surround(ofPane));
    this.speeds.fill(boxes);
    this.stage.draw();
  }

  /** Of the scans in the panes: [{name, threshold}]; the motion map has none. */
  #thresholds() {
    if (this.state.get('view') === 'map') return [];
    return this.#shown.flatMap((r) => {
      const { threshold_name: name, result } = this.content.results[r];
      const threshold = result.scans[this.state.get('scan')]?.threshold ?? null;
      return name && threshold !== null ? [{ name, threshold }] : [];
    });
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
    const spot = this.stage.paneAt(x, y);
    if (!spot) return;
    const { width, height } = this.stage.grid();
    const { geometry } = this.stage.panes[spot.pane];
    const at = { x: spot.x, y: spot.y, width, height };
    const point = pick(this.scans[spot.pane].positions_m, geometry.getAttribute('size').array, this.stage.clipMatrix(), at);
    this.details.hidden = point < 0;
    if (point < 0) return;
    const scores = this.#shown.map((r) => this.clouds.scoreName(r));
    this.details.replaceChildren(pointDetails(this.scans, spot.pane, point, this.names(), scores));
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
