/** Where the eye is. Metres in the sensor's frame (x ahead, z up), in the map's for the last one. */

export const VIEWS = [
  { key: 'orbit', name: 'Orbit' },
  { key: 'top', name: 'Top' },
  { key: 'sensor', name: 'Sensor' },
  { key: 'map', name: 'Motion map' },
];

/** [low, high] of one axis without the outermost twentieth at either end. */
function span(positions_m, axis) {
  const along = [];
  for (let i = axis; i < positions_m.length; i += 3) along.push(positions_m[i]);
  along.sort((a, b) => a - b);
  return along.length > 0 ? [along[Math.floor(0.05 * along.length)], along[Math.floor(0.95 * (along.length - 1))]] : [0, 0];
}

/** Middle and half width, metres, of what moved and of the way of the sensor; at least 10 m. */
export function extent({ positions_m, path }) {
  const ways = path.flat();
  const [x, y] = [0, 1].map((axis) => {
    const [a, b] = [span(positions_m, axis), span(ways, axis)];
    return [Math.min(a[0], b[0]), Math.max(a[1], b[1])];
  });
  const middle = [(x[0] + x[1]) / 2, (y[0] + y[1]) / 2];
  return { middle, reach_m: Math.max(10, (x[1] - x[0]) / 2, (y[1] - y[0]) / 2) };
}

/** What Stage.look takes; `cloud` is what the map view shows. */
export function viewpoint(key, cloud = null) {
  switch (key) {
    case 'top':
      return { eye: [-0.01, 0, 62], target: [0, 0, 0], angle: 50, rotate: false };
    case 'sensor':
      return { eye: [-0.02, 0, 0], target: [0, 0, 0], angle: 75, pan: false, zoom: false };
    case 'map': {
      const { middle, reach_m } = extent(cloud);
      return { eye: [middle[0] - 0.01, middle[1], 2.8 * reach_m], target: [...middle, 0], angle: 50 };
    }
    default:
      return { eye: [-22, -13, 17], target: [4, 0, -1], angle: 55 };
  }
}
