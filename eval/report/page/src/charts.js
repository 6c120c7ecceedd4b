import { objectsChart, rangeChart } from './breakdown_charts.js';
import { Chart } from './chart.js';
import { choice } from './choice.js';
import { comparisonCharts, runNames } from './comparison_charts.js';
import { element } from './dom.js';
import { driftChart } from './path_charts.js';
import { pathsOf, PathView } from './path_view.js';
import { resultsOfSameScans } from './same_scans.js';
import { countsChart, memoryChart, metricsChart, stagesChart, thresholdChart } from './scan_charts.js';

const OVER_SCANS = [metricsChart, countsChart, stagesChart, memoryChart, thresholdChart];
const OVER_BINS = [rangeChart, objectsChart];

/** All charts that the numbers of the chosen result allow, beside those of another run of its scans. */
export class Charts {
  node = element('section', { class: 'charts', 'aria-label': 'Charts' });
  charts = [];

  constructor(state, content, go) {
    Object.assign(this, { state, content, go });
    state.follow(['result', 'other'], () => this.#choosePartner());
    state.follow(['result', 'compared'], () => this.#fill());
    state.follow(['theme'], () => this.charts.forEach((chart) => chart.rebuild()));
    state.follow(['scan'], () => this.charts.forEach((chart) => chart.redraw()));
  }

  /** The run beside it in the 3-D view, else the first of the same scans. */
  #choosePartner() {
    const [first = null] = resultsOfSameScans(this.content, this.state.get('result'));
    this.state.set({ compared: this.state.get('other') ?? first });
  }

  #partnerChoice(result, compared) {
    const others = resultsOfSameScans(this.content, result);
    if (others.length === 0) return [];
    const name = (i) => runNames([this.content.results[result], this.content.results[i]])[1];
    const options = [{ key: '', name: 'nothing' }, ...others.map((i) => ({ key: i, name: name(i) }))];
    const change = (value) => this.state.set({ compared: value === '' ? null : Number(value) });
    return [element('div', { class: 'chart-choice' }, choice('charts beside', options, compared ?? '', change))];
  }

  #fill() {
    const [result, compared] = [this.state.get('result'), this.state.get('compared')];
    const entry = this.content.results[result];
    const x = entry.result.scans.map((_, k) => k);
    const overScans = compared === null ? OVER_SCANS.map((make) => make(entry)).filter(Boolean) : comparisonCharts([entry, this.content.results[compared]]);
    const overBins = OVER_BINS.map((make) => make(entry)).filter(Boolean);
    const ofRun = (note) => (compared === null ? note : `of ${entry.run}; ${note}`);
    const entries = compared === null ? [entry] : [entry, this.content.results[compared]];
    const names = compared === null ? [entry.run] : runNames(entries);
    const drift = driftChart(entries, names);
    this.charts = [
      ...overScans.map((chart) => ({ x, go: this.go, ...chart })),
      ...overBins.map((chart) => ({ ...chart, note: ofRun(chart.note) })),
      ...(drift ? [drift] : []),
    ].map((chart) => new Chart(this.state, chart));
    const paths = pathsOf(entries, names);
    if (paths.length > 0) this.charts.push(new PathView(this.state, paths));
    this.node.replaceChildren(...this.#partnerChoice(result, compared), ...this.charts.map(({ node }) => node));
  }

  /** Numbers of one chart by the labels of its series. */
  numbers(key) {
    return this.charts.find((chart) => chart.key === key)?.numbers() ?? null;
  }
}
