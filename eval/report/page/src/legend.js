import { element } from './dom.js';
import { count } from './format.js';
import { OUTCOMES } from './theme.js';
import { countOutcomes } from './colouring.js';

/** The key to the colours: counts of the shown scan, and a switch per outcome. */
export class Legend {
  node = element('div', { class: 'legend', 'aria-label': 'Outcomes' });

  constructor(state) {
    this.state = state;
    this.rows = OUTCOMES.map((outcome, i) => {
      const swatch = element('span', { class: 'swatch' });
      const name = element('span', { class: 'name' });
      const counts = element('span', { class: 'counts' });
      const row = element(
        'button',
        { type: 'button', 'data-outcome': outcome.key, onclick: () => this.#toggle(i), title: 'Show or hide' },
        swatch,
        name,
        counts,
      );
      return { row, swatch, name, counts };
    });
    this.hidden = element('p', { class: 'hint' });
    this.node.append(...this.rows.map(({ row }) => row), this.hidden);
    state.follow(['theme', 'visible', 'colouring'], () => this.#recolour());
  }

  #toggle(i) {
    this.state.set({ visible: this.state.get('visible').map((on, j) => (j === i ? !on : on)) });
  }

  #recolour() {
    const byOutcome = this.state.get('colouring') === 'outcome';
    OUTCOMES.forEach((outcome, i) => {
      const { row, swatch } = this.rows[i];
      swatch.style.background = byOutcome ? outcome[this.state.get('theme')] : 'transparent';
      row.setAttribute('aria-pressed', String(this.state.get('visible')[i]));
    });
  }

  /** Counts of the scans in the panes, as far as there is room. */
  fill(scans) {
    const perScan = scans.map((scan) => countOutcomes(scan.outcomes));
    const hasTruth = perScan.some((c) => c.slice(0, 4).some((points) => points > 0));
    this.rows.forEach(({ row, name, counts }, i) => {
      const { name: usual, without_truth: plain = usual } = OUTCOMES[i];
      name.textContent = hasTruth ? usual : plain;
      counts.textContent = scans.length > 2 ? '' : perScan.map((c) => count(c[i])).join(' · ');
      row.hidden = perScan.every((c) => c[i] === 0);
    });
    const unseen = scans.length === 0 ? 0 : scans[0].drawable.filter((d) => d === 0).length;
    this.hidden.textContent = unseen > 0 ? `${count(unseen)} of these have no position` : '';
  }
}
