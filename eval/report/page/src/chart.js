import uPlot from 'uplot';
import { chartSvg } from './chart_svg.js';
import { element } from './dom.js';
import { svgButton } from './saving.js';
import { surface } from './theme.js';

const HEIGHT = 210;
const SCAN_STEPS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000];

function axisStyle(theme) {
  const { text, guide } = surface(theme);
  return { stroke: text, font: '12px system-ui, sans-serif', grid: { stroke: guide, width: 0.5 }, ticks: { stroke: guide, width: 0.5 } };
}

/** 150k in place of 150,000, which has no room beside the chart. */
function shortTicks(_, ticks) {
  return ticks.map((tick) => (Math.abs(tick) >= 10000 ? `${tick / 1000}k` : tick.toLocaleString('en-US')));
}

/** A vertical line at the scan that the 3-D view shows. */
function cursorAtScan(state) {
  return (plot) => {
    const x = Math.round(plot.valToPos(state.get('scan'), 'x', true));
    const { left, top, width, height } = plot.bbox;
    if (x < left || x > left + width) return;
    plot.ctx.save();
    plot.ctx.strokeStyle = surface(state.get('theme')).text;
    plot.ctx.setLineDash([4, 4]);
    plot.ctx.beginPath();
    plot.ctx.moveTo(x, top);
    plot.ctx.lineTo(x, top + height);
    plot.ctx.stroke();
    plot.ctx.restore();
  };
}

/** A dot at each of [{x, y, colour}] that has a place. */
function dots(marks, state) {
  return (plot) => {
    const { theme, radius } = { theme: state.get('theme'), radius: 4.5 * devicePixelRatio };
    for (const { x, y, colour } of marks.filter((mark) => mark.x !== null && mark.y !== null)) {
      plot.ctx.save();
      plot.ctx.fillStyle = colour[theme];
      plot.ctx.strokeStyle = surface(theme).background;
      plot.ctx.lineWidth = devicePixelRatio;
      plot.ctx.beginPath();
      plot.ctx.arc(plot.valToPos(x, 'x', true), plot.valToPos(y, 'y', true), radius, 0, 2 * Math.PI);
      plot.ctx.fill();
      plot.ctx.stroke();
      plot.ctx.restore();
    }
  };
}

/** A vertical bar from low to high at each of [{x, low, high, colour}] that has both. */
function whiskers(bars, state) {
  return (plot) => {
    for (const { x, low, high, colour } of bars.filter((bar) => bar.low !== null)) {
      plot.ctx.save();
      plot.ctx.strokeStyle = colour[state.get('theme')];
      plot.ctx.lineWidth = devicePixelRatio;
      plot.ctx.beginPath();
      plot.ctx.moveTo(plot.valToPos(x, 'x', true), plot.valToPos(low, 'y', true));
      plot.ctx.lineTo(plot.valToPos(x, 'x', true), plot.valToPos(high, 'y', true));
      plot.ctx.stroke();
      plot.ctx.restore();
    }
  };
}

/**
 * A chart in a frame with its title. `series`: [{label, values, colour, ...}] over `x`; `options`
 * goes to uPlot. A chart over scans sends clicks to `go` and marks the shown scan.
 */
export class Chart {
  constructor(state, { key, title, note, x, series, options = {}, go = null }) {
    Object.assign(this, { state, key, title, x, series, options, go });
    this.body = element('div', { class: 'chart-body' });
    this.node = element('figure', { class: 'chart', 'data-chart': key },
      element('figcaption', {}, title, note ? element('span', { class: 'hint' }, ` ${note}`) : null, svgButton(key, () => this.svg())), this.body);
    new ResizeObserver(() => this.#fit()).observe(this.body);
  }

  /** The numbers it shows, per series, as they stand in result.json. */
  numbers() {
    return Object.fromEntries(this.series.map(({ label, values }) => [label, values]));
  }

  /** The chart as an svg element. */
  svg() {
    return chartSvg({ plot: this.plot, title: this.title, series: this.series, marks: this.options.marks, theme: this.state.get('theme'), bars });
  }

  #fit() {
    const width = Math.floor(this.body.clientWidth);
    if (width === 0) return;
    if (this.plot) this.plot.setSize({ width, height: HEIGHT });
    else this.#build(width);
  }

  /** Draws again, in the colours of another theme. */
  rebuild() {
    if (!this.plot) return;
    this.plot.destroy();
    this.#build(Math.floor(this.body.clientWidth));
  }

  redraw() {
    this.plot?.redraw(false, false);
  }

  #build(width) {
    const style = axisStyle(this.state.get('theme'));
    const axes = [{ ...style, incrs: this.go ? SCAN_STEPS : undefined, ...this.options.xAxis }, { ...style, size: 58, values: shortTicks, ...this.options.yAxis }];
    const draw = [...(this.go ? [cursorAtScan(this.state)] : []), ...(this.options.marks ? [dots(this.options.marks, this.state)] : []),
      ...(this.options.whiskers ? [whiskers(this.options.whiskers, this.state)] : [])];
    const options = {
      width,
      height: HEIGHT,
      scales: { x: { time: false, ...this.options.xScale }, y: this.options.yScale ?? {} },
      axes,
      series: [{ label: this.options.xLabel ?? 'scan', value: this.options.xValue }, ...this.series.map((s) => this.#line(s))],
      bands: this.options.bands,
      legend: { live: true },
      cursor: { drag: { x: true, y: false }, points: { size: 6 } },
      hooks: { draw },
    };
    this.plot = new uPlot(options, [this.x, ...this.series.map((s) => s.drawn ?? s.values)], this.body);
    if (this.go) this.plot.over.addEventListener('click', () => this.#click());
  }

  #line({ label, colour, values, fill, dash, paths, points, spanGaps, width = 1.5, show = true }) {
    const stroke = typeof colour === 'object' ? colour[this.state.get('theme')] : colour;
    return {
      label, stroke, fill: fill ? fill(stroke) : undefined, dash, width, paths, show, spanGaps,
      points: points ? { fill: stroke, ...points } : { show: values.filter((v) => v !== null).length < 40, size: 4 },
      value: (_, __, ___, i) => (i === null || values[i] === null || values[i] === undefined ? '–' : this.options.text(values[i])),
    };
  }

  #click() {
    const { idx } = this.plot.cursor;
    if (idx !== null && idx !== undefined) this.go(this.x[idx]);
  }
}

/** Bars instead of a line. */
export const bars = uPlot.paths.bars({ size: [0.7, 60] });
