import { objectsChart, rangeChart } from './breakdown_charts.js';
import { Chart } from './chart.js';
import { element } from './dom.js';
import { countsChart, memoryChart, metricsChart, stagesChart, thresholdChart } from './scan_charts.js';

const OVER_SCANS = [metricsChart, countsChart, stagesChart, memoryChart, thresholdChart];
const OVER_BINS = [rangeChart, objectsChart];

/** All charts that the numbers of the chosen result allow. */
export class Charts {
  node = element('section', { class: 'charts', 'aria-label': 'Charts' });
  charts = [];

  constructor(state, content, go) {
    Object.assign(this, { state, content, go });
    state.follow(['result'], () => this.#fill());
    state.follow(['theme'], () => this.charts.forEach((chart) => chart.rebuild()));
    state.follow(['scan'], () => this.charts.forEach((chart) => chart.redraw()));
  }

  #fill() {
    const entry = this.content.results[this.state.get('result')];
    const x = entry.result.scans.map((_, k) => k);
    const overScans = OVER_SCANS.map((make) => make(entry)).filter(Boolean).map((chart) => ({ x, go: this.go, ...chart }));
    const overBins = OVER_BINS.map((make) => make(entry)).filter(Boolean);
    this.charts = [...overScans, ...overBins].map((chart) => new Chart(this.state, chart));
    this.node.replaceChildren(...this.charts.map(({ node }) => node));
  }

  /** Numbers of one chart by the labels of its series. */
  numbers(key) {
    return this.charts.find((chart) => chart.key === key)?.numbers() ?? null;
  }
}
