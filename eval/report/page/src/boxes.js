/** Boxes of moving objects: [x, y, z, yaw, length, width, height, speed], sensor frame, metres. */

const EDGES = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

/** The eight corners, those of the bottom first. */
export function corners([x, y, z, yaw, length, width, height]) {
  const [cos, sin] = [Math.cos(yaw), Math.sin(yaw)];
  return Array.from({ length: 8 }, (_, i) => {
    const ahead = (length / 2) * (i % 4 === 0 || i % 4 === 3 ? 1 : -1);
    const left = (width / 2) * (i % 4 < 2 ? 1 : -1);
    return [x + ahead * cos - left * sin, y + ahead * sin + left * cos, z + (height / 2) * (i < 4 ? -1 : 1)];
  });
}

/** Ends of all edges, one after the other. */
export function edges(boxes) {
  return boxes.flatMap((box) => {
    const at = corners(box);
    return EDGES.flatMap(([from, to]) => [at[from], at[to]]);
  });
}

/** What is written above a box; nothing for an object that was seen once. */
export function speedText([, , , , , , , speed]) {
  return speed === null ? '' : `${speed.toFixed(1)} m/s`;
}

/** Middle of the top, above which the speed is written. */
export function topOf([x, y, z, , , , height]) {
  return [x, y, z + height / 2];
}

/** Where a point is in a pane, CSS pixels from its upper left corner; null outside of it. */
export function placeIn([x, y, z], clip, { width, height }) {
  const row = (r) => clip[r] * x + clip[4 + r] * y + clip[8 + r] * z + clip[12 + r];
  const w = row(3);
  if (w <= 0) return null;
  const [right, up] = [row(0) / w, row(1) / w];
  if (Math.abs(right) > 1 || Math.abs(up) > 1) return null;
  return { x: ((right + 1) / 2) * width, y: ((1 - up) / 2) * height };
}

/** Moves a place up until a text of that size there covers none at the places `taken`, to which it is added. */
export function raised({ x, y }, taken, { width, height }) {
  const covers = (other) => Math.abs(other.x - x) < width && Math.abs(other.y - y) < height - 1e-6;
  for (let other = taken.find(covers); other; other = taken.find(covers)) y = other.y - height;
  taken.push({ x, y });
  return { x, y };
}
