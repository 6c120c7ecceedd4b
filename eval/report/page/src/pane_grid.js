const NARROW = 640; // CSS pixels

function columnsOf(panes, width, height) {
  if (panes === 2) return width < NARROW && height > width ? 1 : 2; // a pane shows more of a scan that is wide
  if (panes < 2) return 1;
  return width < NARROW || panes === 4 ? 2 : 3;
}

/** Columns and rows, and the size of a pane, that show so many clouds on a screen of this size. */
export function paneGrid(panes, { width, height }) {
  const columns = columnsOf(panes, width, height);
  const rows = Math.max(Math.ceil(panes / columns), 1);
  return { columns, rows, width: width / columns, height: height / rows };
}

/** The pane at x, y of the screen, and x, y within it; null where none is. */
export function paneAt({ columns, width, height }, panes, x, y) {
  const [column, row] = [Math.floor(x / width), Math.floor(y / height)];
  const pane = row * columns + column;
  return column < columns && pane < panes ? { pane, x: x - column * width, y: y - row * height } : null;
}
