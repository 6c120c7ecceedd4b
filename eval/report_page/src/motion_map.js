/** All moving points of the scans in the file, in the map's frame. */

const SHOWN = [true, true, true, false, false, true]; // tp, fp, fn, and moving without truth

/** p_map = map_from_sensor * p_sensor, relative to `origin`. */
export function toMap(pose, x, y, z, origin) {
  return [0, 4, 8].map((r, i) => pose[r] * x + pose[r + 1] * y + pose[r + 2] * z + pose[r + 3] - origin[i]);
}

/** Joins the moving points of `scans` to one that can be drawn like a scan. */
export function accumulate(scans) {
  const origin = scans.length > 0 ? [3, 7, 11].map((i) => scans[0].pose[i]) : [0, 0, 0];
  const positions = [];
  const outcomes = [];
  for (const scan of scans) {
    for (let i = 0; i < scan.points; ++i) {
      if (!SHOWN[scan.outcomes[i]] || !scan.drawable[i]) continue;
      const [x, y, z] = scan.positions_m.subarray(3 * i, 3 * i + 3);
      positions.push(...toMap(scan.pose, x, y, z, origin));
      outcomes.push(scan.outcomes[i]);
    }
  }
  return {
    points: outcomes.length,
    stem: `${scans.length} scans`,
    positions_m: Float32Array.from(positions),
    outcomes: Uint8Array.from(outcomes),
    drawable: new Uint8Array(outcomes.length).fill(1),
    path: scans.map((scan) => toMap(scan.pose, 0, 0, 0, origin)),
    pose: null,
  };
}
