import { Color, LineBasicMaterial, PerspectiveCamera, PointsMaterial, ShaderMaterial, WebGLRenderer } from 'three';
import { element } from './dom.js';
import { Pane } from './pane.js';
import { paneAt, paneGrid } from './pane_grid.js';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const VERTEX = `
attribute float size;
attribute vec3 shade;
varying vec3 colour;
uniform float pixelRatio;
void main() {
  colour = shade;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = size * pixelRatio;
  if (size == 0.0) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
}`;
const FRAGMENT = `
varying vec3 colour;
void main() {
  vec2 off = gl_PointCoord - 0.5;
  if (dot(off, off) > 0.25) discard;
  gl_FragColor = vec4(colour, 1.0);
}`;
/**
 * Draws clouds side by side with one camera, so that they cannot get out of step. Throws when the
 * browser has no WebGL.
 */
export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    // Screenshots and tests read the picture after it was shown.
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.autoClear = false;
    this.pointMaterial = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: { pixelRatio: { value: 1 } },
    });
    this.guideMaterial = new LineBasicMaterial();
    this.contextMaterial = new PointsMaterial({ size: 1, sizeAttenuation: false });
    this.boxMaterial = new LineBasicMaterial();
    this.onDrawn = () => {};
    this.panes = [];
    this.shown = 0;
    this.camera = new PerspectiveCamera(55, 1, 0.05, 3000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.draw());
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  setTheme({ background, guide, text }) {
    this.renderer.setClearColor(new Color().setStyle(background), 1);
    this.guideMaterial.color.setStyle(guide);
    this.contextMaterial.color.setStyle(guide);
    this.boxMaterial.color.setStyle(text);
    this.draw();
  }

  /** `eye` and `target` in metres; the angle of view in degrees; what the pointer may do. */
  look({ eye, target, angle, rotate = true, pan = true, zoom = true }) {
    this.camera.position.set(...eye);
    this.camera.fov = angle;
    Object.assign(this.controls, { enableRotate: rotate, enablePan: pan, enableZoom: zoom });
    this.controls.mouseButtons.LEFT = rotate ? 0 : 2;
    this.controls.touches.ONE = rotate ? 0 : 1;
    this.controls.target.set(...target);
    this.controls.update();
    this.draw();
  }

  /** Shows the first so many panes. */
  show(panes) {
    while (this.panes.length < panes) this.panes.push(new Pane(this.pointMaterial, this.guideMaterial, this.contextMaterial, this.boxMaterial));
    this.shown = panes;
  }

  /** Columns, rows, and width and height of one pane in CSS pixels. */
  grid() {
    return paneGrid(this.shown, { width: this.canvas.clientWidth, height: this.canvas.clientHeight });
  }

  /** The pane at these pixels of the canvas and the pixels within it, or null. */
  paneAt(x, y) {
    return paneAt(this.grid(), this.shown, x, y);
  }

  /** 4x4 matrix from metres to the unit cube of the screen, columns first. */
  clipMatrix() {
    this.camera.updateMatrixWorld();
    return this.camera.projectionMatrix.clone().multiply(this.camera.matrixWorldInverse).elements;
  }

  /** Draws before the browser shows its next picture, however often it is called until then. */
  draw() {
    this.pending ??= requestAnimationFrame(() => {
      this.pending = null;
      this.#drawNow();
    });
  }

  /** Only when something changed: each call makes a new picture buffer. */
  #resize(width, height, ratio) {
    const size = `${width} ${height} ${ratio}`;
    if (size === this.size) return;
    this.size = size;
    this.renderer.setDrawingBufferSize(width, height, ratio);
    this.pointMaterial.uniforms.pixelRatio.value = ratio;
  }

  /** {eye, target}, metres. */
  camera_m() {
    return { eye: this.camera.position.toArray(), target: this.controls.target.toArray() };
  }

  /** A canvas with what is shown, without the background, in `ratio` pixels per pixel of the page. */
  picture(ratio) {
    const background = this.renderer.getClearColor(new Color());
    this.renderer.setClearColor(background, 0);
    this.#drawNow(ratio);
    const copy = element('canvas', { width: this.canvas.width, height: this.canvas.height });
    copy.getContext('2d').drawImage(this.canvas, 0, 0);
    this.renderer.setClearColor(background, 1);
    this.#drawNow();
    return copy;
  }

  #drawNow(ratio = Math.min(devicePixelRatio, 2)) {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.#resize(clientWidth, clientHeight, ratio);
    const { columns, rows, width, height } = this.grid();
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.renderer.setScissorTest(false);
    this.renderer.clear();
    this.renderer.setScissorTest(true);
    for (let p = 0; p < this.shown; ++p) {
      const corner = [(p % columns) * width, (rows - 1 - Math.floor(p / columns)) * height]; // counted from below
      this.renderer.setViewport(...corner, width, height);
      this.renderer.setScissor(...corner, width, height);
      this.renderer.render(this.panes[p].scene, this.camera);
    }
    this.onDrawn();
  }
}
