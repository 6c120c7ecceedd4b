import { element, shape } from './dom.js';
import { fixed } from './format.js';
import { svgButton } from './saving.js';
import { runLine, surface } from './theme.js';

const LINE_STEPS_M = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000];
const MOST_LINES = 8;
const HEIGHT = 210; // as the charts beside it
const WIDTH = 500;

/** The paths to draw: that of the data set itself where it is another one, then those of the runs. */
export function pathsOf(entries, names) {
  const paths = entries.map(({ path }, i) => (path ? { label: names[i], points_m: path.run_m, key: i } : null)).filter(Boolean);
  const own = entries.find(({ path }) => path?.own_m)?.path.own_m;
  return own ? [{ label: 'poses of the data set', points_m: own, key: null }, ...paths] : paths;
}

/** Lowest corner and size, metres, of the frame around all paths, of the shape of the drawing. */
export function frameOf(paths) {
  const points = paths.flatMap(({ points_m }) => points_m);
  const ends = [0, 1].map((axis) => points.reduce(([low, high], p) => [Math.min(low, p[axis]), Math.max(high, p[axis])], [Infinity, -Infinity]));
  const reach = ends.map(([low, high]) => high - low);
  const height = 1.1 * Math.max(reach[1], (reach[0] * HEIGHT) / WIDTH, 1);
  const size = [(height * WIDTH) / HEIGHT, height];
  return { low: ends.map(([low, high], axis) => (low + high - size[axis]) / 2), size };
}

/** Metres between the lines of the grid. */
export function gridStep_m({ size }) {
  return LINE_STEPS_M.find((step) => size[0] / step <= MOST_LINES) ?? LINE_STEPS_M.at(-1);
}

function grid({ low, size }, step_m, colour) {
  const within = (axis) => {
    const first = Math.ceil(low[axis] / step_m);
    return Array.from({ length: Math.floor((low[axis] + size[axis]) / step_m) - first + 1 }, (_, i) => (first + i) * step_m);
  };
  const line = (ends) => shape('line', { ...ends, stroke: colour, 'stroke-width': 0.5, 'vector-effect': 'non-scaling-stroke' });
  return [
    ...within(0).map((x) => line({ x1: x, x2: x, y1: -low[1] - size[1], y2: -low[1] })),
    ...within(1).map((y) => line({ y1: -y, y2: -y, x1: low[0], x2: low[0] + size[0] })),
  ];
}

/** The ways of the sensor from above, with a dot at the scan that the 3-D view shows. */
export class PathView {
  key = 'path';

  constructor(state, paths) {
    Object.assign(this, { state, paths });
    this.frame = frameOf(paths);
    this.body = element('div', { class: 'chart-body' });
    const step_m = gridStep_m(this.frame);
    this.node = element('figure', { class: 'chart', 'data-chart': this.key },
      element('figcaption', {}, 'Way of the sensor', element('span', { class: 'hint' }, ` from above, map frame; a line every ${fixed(step_m, 0, 'm')}`), svgButton(this.key, () => this.svg())), this.body);
    this.rebuild();
  }

  numbers() {
    return Object.fromEntries(this.paths.map(({ label, points_m }) => [label, points_m]));
  }

  /** The drawing as an svg element of its own. */
  svg() {
    const drawing = this.body.querySelector('svg').cloneNode(true);
    drawing.setAttribute('width', WIDTH);
    drawing.setAttribute('height', HEIGHT);
    return drawing;
  }

  #colour(key) {
    const theme = this.state.get('theme');
    return key === null ? surface(theme).text : runLine(key).colour[theme];
  }

  #line({ points_m, key }) {
    return shape('polyline', {
      points: points_m.map(([x, y]) => `${x},${-y}`).join(' '), fill: 'none', stroke: this.#colour(key),
      'stroke-width': key === null ? 3 : 1.5, 'stroke-opacity': key === null ? 0.45 : 1, 'vector-effect': 'non-scaling-stroke',
    });
  }

  #legend() {
    return element('div', { class: 'path-legend' }, ...this.paths.map(({ label, key }) => {
      const swatch = element('span', { class: 'swatch' });
      swatch.style.background = this.#colour(key);
      return element('span', {}, swatch, label);
    }));
  }

  rebuild() {
    const { low, size } = this.frame;
    const lines = grid(this.frame, gridStep_m(this.frame), surface(this.state.get('theme')).guide);
    this.dots = this.paths.filter(({ key }) => key !== null).map(({ key }) => shape('circle', { r: size[1] / 50, fill: this.#colour(key) }));
    const drawing = shape('svg', { viewBox: `${low[0]} ${-low[1] - size[1]} ${size[0]} ${size[1]}`, role: 'img', 'aria-label': 'Way of the sensor from above' },
      ...lines, ...this.paths.map((path) => this.#line(path)), ...this.dots);
    this.body.replaceChildren(drawing, this.#legend());
    this.redraw();
  }

  redraw() {
    const drawn = this.paths.filter(({ key }) => key !== null);
    this.dots.forEach((dot, i) => {
      const [x, y] = drawn[i].points_m[this.state.get('scan')];
      dot.setAttribute('cx', x);
      dot.setAttribute('cy', -y);
    });
  }
}
