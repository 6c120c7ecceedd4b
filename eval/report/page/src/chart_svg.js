import { shape } from './dom.js';
import { surface } from './theme.js';

const TOP = 30;
const LEGEND_LINE = 18;
const FONT = 'system-ui, "DejaVu Sans", sans-serif';

function text(x, y, content, colour, attributes = {}) {
  return shape('text', { x, y, fill: colour, 'font-family': FONT, 'font-size': 12, ...attributes }, content);
}

/** Places of the values that there are, in stretches without gaps; `spans` draws over gaps. */
function stretches(values, place, spans) {
  const lines = [[]];
  values.forEach((value, i) => {
    if (value !== null && value !== undefined) lines.at(-1).push(place(i, value));
    else if (!spans && lines.at(-1).length > 0) lines.push([]);
  });
  return lines.filter((line) => line.length > 0);
}

const pointsOf = (places) => places.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(' ');

function barNodes(places, colour, base, width) {
  return places.map(([x, y]) => shape('rect', { x: (x - width / 2).toFixed(1), y: Math.min(y, base).toFixed(1), width: width.toFixed(1), height: Math.abs(base - y).toFixed(1), fill: colour }));
}

/** What draws one series: bars, an area down to zero, or a line with dots where it has few points. */
function seriesNodes(series, plot, colour, bars) {
  const place = (i, value) => [plot.valToPos(plot.data[0][i], 'x'), plot.valToPos(value, 'y')];
  const lines = stretches(series.drawn ?? series.values, place, series.spanGaps);
  const base = plot.valToPos(Math.max(plot.scales.y.min, 0), 'y');
  if (series.paths === bars) {
    const step = (plot.bbox.width / devicePixelRatio) / Math.max(plot.data[0].length, 1);
    return barNodes(lines.flat(), colour, base, Math.min(60, 0.7 * step));
  }
  return lines.flatMap((line) => {
    if (series.fill) return [shape('polygon', { points: `${line[0][0]},${base} ${pointsOf(line)} ${line.at(-1)[0]},${base}`, fill: colour })];
    if (line.length === 1) return [shape('circle', { cx: line[0][0], cy: line[0][1], r: 2, fill: colour })];
    return [shape('polyline', { points: pointsOf(line), fill: 'none', stroke: colour, 'stroke-width': series.width ?? 1.5, 'stroke-dasharray': series.dash?.join(' ') })];
  });
}

function axisNodes(plot, width, height, { text: ink, guide }) {
  const [x, y] = plot.axes;
  const of = (axis) => axis._splits.map((split, i) => [split, axis._values[i]]).filter(([, label]) => label !== null && label !== '');
  return [
    ...of(x).flatMap(([split, label]) => {
      const at = plot.valToPos(split, 'x');
      return [shape('line', { x1: at, x2: at, y1: 0, y2: height, stroke: guide, 'stroke-width': 0.5 }), text(at, height + 16, String(label), ink, { 'text-anchor': 'middle' })];
    }),
    ...of(y).flatMap(([split, label]) => {
      const at = plot.valToPos(split, 'y');
      return [shape('line', { x1: 0, x2: width, y1: at, y2: at, stroke: guide, 'stroke-width': 0.5 }), text(-6, at + 4, String(label), ink, { 'text-anchor': 'end' })];
    }),
  ];
}

function legendNodes(series, ink) {
  return series.flatMap(({ label, colour }, i) => [
    shape('rect', { x: 0, y: LEGEND_LINE * i - 9, width: 12, height: 10, fill: colour }), text(18, LEGEND_LINE * i, label, ink),
  ]);
}

/**
 * The chart as it is shown, as lines that can be scaled: what a uPlot chart drew into pixels. `series` as Chart has
 * them, `marks`: dots [{x, y, colour}].
 */
export function chartSvg({ plot, title, series, marks = [], theme, bars }) {
  const { text: ink, guide } = surface(theme);
  const inTheme = (colour) => (typeof colour === 'object' ? colour[theme] : colour);
  const shown = series.map((one, i) => ({ ...one, colour: inTheme(one.colour), hidden: !plot.series[i + 1].show })).filter(({ hidden }) => !hidden);
  const [left, width, height] = [plot.bbox.left, plot.bbox.width, plot.bbox.height].map((pixels) => pixels / devicePixelRatio);
  const whole = [left + width + 24, TOP + height + 34 + LEGEND_LINE * shown.length];
  const dots = marks.filter(({ x, y }) => x !== null && y !== null)
    .map(({ x, y, colour }) => shape('circle', { cx: plot.valToPos(x, 'x'), cy: plot.valToPos(y, 'y'), r: 4.5, fill: inTheme(colour) }));
  return shape('svg', { viewBox: `0 0 ${whole[0]} ${whole[1]}`, width: whole[0], height: whole[1] },
    text(4, 18, title, ink, { 'font-weight': 600, 'font-size': 14 }),
    shape('g', { transform: `translate(${left} ${TOP})` }, ...axisNodes(plot, width, height, { text: ink, guide }),
      ...shown.flatMap((one) => seriesNodes(one, plot, one.colour, bars)), ...dots),
    shape('g', { transform: `translate(${left} ${TOP + height + 40})` }, ...legendNodes(shown, ink)));
}
