import { BufferAttribute, BufferGeometry, Group, LineLoop, Line, LineSegments, Points, Scene, Vector3 } from 'three';
import { edges } from './boxes.js';

const RINGS_M = [10, 20, 30, 40, 50];
const SEGMENTS = 96;

function ring(radius_m, material) {
  const at = (s) => (2 * Math.PI * s) / SEGMENTS;
  const corners = Array.from({ length: SEGMENTS }, (_, s) => new Vector3(radius_m * Math.cos(at(s)), radius_m * Math.sin(at(s)), 0));
  return new LineLoop(new BufferGeometry().setFromPoints(corners), material);
}

function axes(material) {
  const ends = [[-1, 0, 0], [3, 0, 0], [0, -1, 0], [0, 1, 0]].map((p) => new Vector3(...p));
  return new LineSegments(new BufferGeometry().setFromPoints(ends), material);
}

/** One scan as the graphics card gets it. */
export class Pane {
  scene = new Scene();
  geometry = new BufferGeometry();

  constructor(pointMaterial, guideMaterial, contextMaterial, boxMaterial) {
    const cloud = new Points(this.geometry, pointMaterial);
    this.context = new Points(new BufferGeometry(), contextMaterial);
    cloud.frustumCulled = this.context.frustumCulled = false;
    this.guides = new Group();
    this.guides.add(...RINGS_M.map((radius_m) => ring(radius_m, guideMaterial)), axes(guideMaterial));
    this.path = new Line(new BufferGeometry(), guideMaterial);
    this.path.frustumCulled = false;
    this.boxes = new LineSegments(new BufferGeometry(), boxMaterial);
    this.boxes.frustumCulled = false;
    this.scene.add(this.context, cloud, this.guides, this.path, this.boxes);
  }

  /** Replaces the boxes. */
  surround(boxes) {
    this.boxes.geometry.dispose();
    this.boxes.geometry = new BufferGeometry().setFromPoints(edges(boxes).map((p) => new Vector3(...p)));
  }

  /** `path`: way of the sensor, `context`: positions of what stands still; both null but in the motion map. */
  fill(positions_m, colours, sizes, path, context) {
    this.geometry.setAttribute('position', new BufferAttribute(positions_m, 3));
    this.geometry.setAttribute('shade', new BufferAttribute(colours, 3, true));
    this.geometry.setAttribute('size', new BufferAttribute(sizes, 1));
    this.geometry.setDrawRange(0, sizes.length);
    this.context.visible = context !== null;
    if (context && context !== this.contextShown) this.context.geometry.setAttribute('position', new BufferAttribute(context, 3));
    this.contextShown = context;
    this.guides.visible = path === null;
    this.path.visible = path !== null;
    if (path) this.path.geometry.setFromPoints(path.map((p) => new Vector3(...p)));
  }
}
