import { objectsChart, rangeChart } from './breakdown_charts.js';
import { Chart } from './chart.js';
import { comparisonCharts } from './comparison_charts.js';
import { element } from './dom.js';
import { driftChart } from './path_charts.js';
import { pathsOf, PathView } from './path_view.js';
import { runNames, runOptions, RunsMenu } from './runs_menu.js';
import { resultsOfSameScans } from './same_scans.js';
import { countsChart, memoryChart, metricsChart, stagesChart, thresholdChart } from './scan_charts.js';
import { scoreCurveChart } from './score_curve.js';

const OVER_SCANS = [metricsChart, countsChart, stagesChart, memoryChart, thresholdChart];
const OVER_BINS = [rangeChart, objectsChart];

/** All charts that the numbers of the chosen result allow, beside those of other runs of its scans. */
export class Charts {
  node = element('section', { class: 'charts', 'aria-label': 'Charts' });
  charts = [];

  constructor(state, content, go) {
    Object.assign(this, { state, content, go });
    this.menu = new RunsMenu('charts beside', (compared) => state.set({ compared }));
    state.follow(['result', 'others'], () => this.#choosePartners());
    state.follow(['result', 'compared'], () => this.#fill());
    state.follow(['theme'], () => this.charts.forEach((chart) => chart.rebuild()));
    state.follow(['scan'], () => this.charts.forEach((chart) => chart.redraw()));
  }

  #sameScans() {
    return resultsOfSameScans(this.content, this.state.get('result'));
  }

  /** The runs beside it in the 3-D view, else the first of the same scans. */
  #choosePartners() {
    const others = this.state.get('others');
    this.state.set({ compared: others.length > 0 ? others : this.#sameScans().slice(0, 1) });
  }

  #fillMenu(result, compared) {
    const others = this.#sameScans();
    this.menu.fill(runOptions(this.content, result, others), compared);
    return others.length === 0 ? [] : [element('div', { class: 'chart-choice' }, this.menu.node)];
  }

  /** What is shown and then the others of the same scans; null where another protocol or range counted. */
  #ofSameRules(result) {
    const shown = [result, ...this.state.get('compared')];
    const rules = (i) => JSON.stringify(this.content.results[i].result.protocol);
    const all = [...shown, ...this.#sameScans().filter((i) => !shown.includes(i))];
    return all.map((i) => (rules(i) === rules(result) ? i : null));
  }

  #chartsOf(entries, result) {
    const [entry, ...others] = entries;
    const x = entry.result.scans.map((_, k) => k);
    const overScans = others.length === 0 ? OVER_SCANS.map((make) => make(entry)).filter(Boolean) : comparisonCharts(entries);
    const overBins = OVER_BINS.map((make) => make(entry)).filter(Boolean);
    const ofRun = (note) => (others.length === 0 ? note : `of ${entry.run}; ${note}`);
    const ofAll = [scoreCurveChart(this.content.curves, this.#ofSameRules(result)), driftChart(entries, runNames(entries))];
    return [
      ...overScans.map((chart) => ({ x, go: this.go, ...chart })),
      ...overBins.map((chart) => ({ ...chart, note: ofRun(chart.note) })),
      ...ofAll.filter(Boolean),
    ];
  }

  #fill() {
    const [result, compared] = [this.state.get('result'), this.state.get('compared')];
    const entries = [result, ...compared].map((i) => this.content.results[i]);
    this.charts = this.#chartsOf(entries, result).map((chart) => new Chart(this.state, chart));
    const paths = pathsOf(entries, runNames(entries));
    if (paths.length > 0) this.charts.push(new PathView(this.state, paths));
    this.node.replaceChildren(...this.#fillMenu(result, compared), ...this.charts.map(({ node }) => node));
  }

  /** Numbers of one chart by the labels of its series. */
  numbers(key) {
    return this.charts.find((chart) => chart.key === key)?.numbers() ?? null;
  }
}
