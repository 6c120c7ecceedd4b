/** Where the eye is. Metres in the sensor's frame (x ahead, z up), in the map's for the last one. */

export const VIEWS = [
  { key: 'orbit', name: 'Orbit' },
  { key: 'top', name: 'Top' },
  { key: 'sensor', name: 'Sensor' },
  { key: 'map', name: 'Motion map' },
];

function middle(path) {
  const sum = [0, 1].map((axis) => path.reduce((total, p) => total + p[axis], 0));
  return path.length > 0 ? sum.map((total) => total / path.length) : [0, 0];
}

/** How far the path and what moved about it reach, metres. */
export function reach(positions_m, [x, y]) {
  const distances = [];
  for (let i = 0; i < positions_m.length; i += 3) distances.push(Math.hypot(positions_m[i] - x, positions_m[i + 1] - y));
  distances.sort((a, b) => a - b);
  return Math.max(10, distances[Math.floor(0.95 * distances.length)] ?? 10);
}

/** What Stage.look takes; `cloud` is what the map view shows. */
export function viewpoint(key, cloud = null) {
  switch (key) {
    case 'top':
      return { eye: [-0.01, 0, 62], target: [0, 0, 0], angle: 50, rotate: false };
    case 'sensor':
      return { eye: [-0.02, 0, 0], target: [0, 0, 0], angle: 75, pan: false, zoom: false };
    case 'map': {
      const [x, y] = middle(cloud.path);
      return { eye: [x - 0.01, y, 2.4 * reach(cloud.positions_m, [x, y])], target: [x, y, 0], angle: 50 };
    }
    default:
      return { eye: [-22, -13, 17], target: [4, 0, -1], angle: 55 };
  }
}
