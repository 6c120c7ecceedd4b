const NARROW = 640; // CSS pixels

/** Columns and rows, and the size of a pane, that show so many clouds on a screen of this size. */
export function paneGrid(panes, { width, height }) {
  const most = panes <= 2 ? panes : width < NARROW || panes === 4 ? 2 : 3;
  const columns = Math.max(most, 1);
  const rows = Math.max(Math.ceil(panes / columns), 1);
  return { columns, rows, width: width / columns, height: height / rows };
}

/** The pane at x, y of the screen, and x, y within it; null where none is. */
export function paneAt({ columns, width, height }, panes, x, y) {
  const [column, row] = [Math.floor(x / width), Math.floor(y / height)];
  const pane = row * columns + column;
  return column < columns && pane < panes ? { pane, x: x - column * width, y: y - row * height } : null;
}
