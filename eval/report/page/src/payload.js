/** The report's content: what `mosbench report` wrote into the page. */

/** @returns the JSON that holds everything but points. */
export function readContent(root = document) {
  return JSON.parse(root.getElementById('report').textContent);
}

/** Bytes of one compressed block. Blocks stay text until a scan is looked at. */
export async function readBlock(index, root = document) {
  const text = atob(root.getElementById(`block-${index}`).textContent);
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < packed.length; ++i) packed[i] = text.charCodeAt(i); // Uint8Array.from takes ten times as long
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Positions in metres, x y z per point, from the planes that eval/report/point_planes.cpp describes. */
export function positionsFromPlanes(planes, step_m) {
  const points = planes.length / 6;
  const positions_m = new Float32Array(3 * points);
  for (let axis = 0; axis < 3; ++axis) {
    let steps = 0;
    for (let i = 0; i < points; ++i) {
      const code = planes[axis * points + i] | (planes[(3 + axis) * points + i] << 8);
      steps = ((steps + ((code >> 1) ^ -(code & 1))) << 16) >> 16;
      positions_m[3 * i + axis] = steps * step_m;
    }
  }
  return positions_m;
}

/** Dynamic scores, from the planes that eval/report/point_planes.cpp describes. */
export function scoresFromPlanes(planes) {
  const points = planes.length / 4;
  const bits = Uint32Array.from({ length: points }, (_, i) =>
    planes[i] | (planes[points + i] << 8) | (planes[2 * points + i] << 16) | (planes[3 * points + i] << 24));
  return new Float32Array(bits.buffer);
}

/** Radial velocities in m/s, NaN where not known, from the planes that eval/report/point_planes.cpp describes. */
export function velocitiesFromPlanes(planes, step_m_s) {
  const points = planes.length / 2;
  const UNKNOWN = -32768;
  return Float32Array.from({ length: points }, (_, i) => {
    const steps = ((planes[i] | (planes[points + i] << 8)) << 16) >> 16;
    return steps === UNKNOWN ? NaN : steps * step_m_s;
  });
}

/** Splits a plane of outcomes into what each point counts as and whether it has a position. */
export function outcomesFromPlane(plane) {
  const outcomes = plane.map((byte) => byte & 7);
  const drawable = plane.map((byte) => (byte & 8 ? 0 : 1));
  return { outcomes, drawable };
}
