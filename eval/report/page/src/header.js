import { element } from './dom.js';

/** "run · sequence" of a result. */
export function resultName(entry) {
  return `${entry.run} · ${entry.result.sequence}`;
}

function resultChoice(state, content, choose) {
  const select = element('select', { 'aria-label': 'Result', onchange: () => choose(Number(select.value)) });
  select.append(...content.results.map((entry, i) => element('option', { value: i }, resultName(entry))));
  state.follow(['result'], () => (select.value = state.get('result')));
  return select;
}

/** Name of what is looked at, choice of the result, theme. */
export function header(state, content, choose) {
  const title = element('h1', {});
  state.follow(['result'], () => {
    title.textContent = resultName(content.results[state.get('result')]);
    document.title = `${title.textContent} – mosbench`;
  });
  const theme = element('button', {
    type: 'button',
    title: 'Light or dark (t)',
    'aria-label': 'Light or dark',
    onclick: () => state.set({ theme: state.get('theme') === 'dark' ? 'light' : 'dark' }),
  }, '◐');
  const picker = content.results.length > 1 ? resultChoice(state, content, choose) : null;
  return element('header', {}, element('span', { class: 'mark' }, 'mosbench'), picker ?? title, element('span', { class: 'grow' }), theme);
}
