/** Elements are made here and nowhere else: strings only ever become text, never markup. */

const SVG = 'http://www.w3.org/2000/svg';

function fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else if (value === true) node.setAttribute(name, '');
    else if (value !== false && value !== null && value !== undefined) node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/** `element('td', {class: 'n'}, 'text', child)`; attributes `on…` are listeners. */
export function element(tag, attributes = {}, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

/** The same for parts of a drawing. */
export function shape(tag, attributes = {}, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

/** A part of the page under a title of its own, with a note where there is one. */
export function block(title, note, body) {
  return element('section', { class: 'block' }, element('h2', {}, title), note ? element('p', { class: 'hint' }, note) : null, body);
}

/** A table from column titles and rows of cells; a cell is text, a node, or {text, title}. */
export function table(titles, rows, { leftColumns = 1, onRow = null } = {}) {
  const side = (i) => (i < leftColumns ? 'left' : 'right');
  const head = element('tr', {}, ...titles.map((t, i) => element('th', { class: side(i), scope: 'col' }, t)));
  const body = rows.map((cells, r) => {
    const row = element('tr', {}, ...cells.map((c, i) => element('td', { class: side(i) }, c ?? '')));
    if (onRow) {
      row.classList.add('link');
      row.tabIndex = 0;
      row.addEventListener('click', () => onRow(r));
      row.addEventListener('keydown', (event) => event.key === 'Enter' && onRow(r));
    }
    return row;
  });
  return element(
    'div',
    { class: 'table' },
    element('table', {}, element('thead', {}, head), element('tbody', {}, ...body)),
  );
}
