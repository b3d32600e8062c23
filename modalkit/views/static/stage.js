// A canvas on which a structure stands: camera, light loop, and the point that the mouse is over. Drawn by three.js.

import * as THREE from "./three.module.min.js";
import { orbit } from "./orbit.js";

const NEAR = 16; // pixels within which a point is meant

const FINE = 2; // pixels drawn per pixel of the page at the most; beyond, nothing more is seen

const STILL = 200; // milliseconds without a change after which a picture is drawn as fine as it can be

const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i; // what draws without a graphics card

/** Tell whether a page is drawn in software: its browser says so, or gives no fast context. */
function software() {
  const wanted = { failIfMajorPerformanceCaveat: true };
  const gl = document.createElement("canvas").getContext("webgl2", wanted);
  if (!gl) return true;
  const told = gl.getExtension("WEBGL_debug_renderer_info");
  const name = gl.getParameter(told ? told.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return SOFTWARE.test(name);
}

/** A canvas with a camera; what is drawn says `places()`, the points that are seen, and `pose()`, how they stand. */
export class Stage {
  constructor(canvas, colours, { kept = false } = {}) {
    this.canvas = canvas;
    this.soft = software();
    // In software several samples of each pixel cost more than all else: none are taken, and nothing shows through.
    const fast = { antialias: !this.soft, alpha: !this.soft };
    this.renderer = new THREE.WebGLRenderer({ canvas, ...fast, preserveDrawingBuffer: kept });
    canvas.dataset.soft = this.soft;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.orbit = orbit(canvas, this.camera, () => {
      this.dirty = true;
    });
    this.recolour(colours);
    this.watcher = new ResizeObserver(() => this.resize());
    this.watcher.observe(canvas.parentElement);
    this.frames = 0;
    this.since = performance.now();
    const loop = (now) => {
      if (this.closed) return;
      this.frame(now);
      requestAnimationFrame(loop);
    };
    requestAnimationFrame(loop);
  }

  recolour(colours) {
    this.colours = colours;
    if (this.soft) this.renderer.setClearColor(colours.panel);
    this.dirty = true;
  }

  /** Take the size of all that is shown. */
  measure(places) {
    const low = [0, 1, 2].map((k) => Math.min(...places.map((p) => p[k])));
    const high = [0, 1, 2].map((k) => Math.max(...places.map((p) => p[k])));
    this.size = Math.hypot(...low.map((v, k) => high[k] - v)) || 1;
    this.spread = [0, 1, 2].map((k) => high[k] - low[k]);
    this.centre = low.map((v, k) => (v + high[k]) / 2);
  }

  aimAt(centre, places, reach) {
    const corners = places.flatMap((p) =>
      [0, 1, 2].flatMap((k) => [-reach, reach].map((d) => p.map((v, i) => v + (i === k ? d : 0)))),
    );
    this.orbit.aim(centre, corners, this.camera.aspect);
  }

  resize() {
    const box = this.canvas.parentElement.getBoundingClientRect();
    if (!box.width || !this.size) return;
    this.renderer.setSize(box.width, box.height, false);
    this.camera.aspect = box.width / box.height;
    this.aim();
  }

  frame(now) {
    const step = Math.min(100, now - (this.last ?? now)) / 1000;
    this.last = now;
    this.advance(step);
    const still = !this.dirty && now - this.finished > STILL;
    if (!this.ready() || !(this.dirty || (this.soft && still && this.refine(FINE)))) return;
    if (this.dirty) {
      this.refine(this.soft ? 1 : Math.min(FINE, window.devicePixelRatio));
      this.finished = now;
    }
    this.dirty = false;
    const begun = performance.now();
    this.pose();
    this.renderer.render(this.scene, this.camera);
    this.work = (this.work ?? 0) + performance.now() - begun;
    this.frames += 1;
    if (now - this.since > 1000) {
      this.canvas.dataset.fps = ((1000 * this.frames) / (now - this.since)).toFixed(1);
      this.canvas.dataset.work = (this.work / this.frames).toFixed(2);
      this.frames = this.work = 0;
      this.since = now;
    }
  }

  /** Set how many pixels are drawn per pixel of the page, tell whether that is news. */
  refine(ratio) {
    const news = ratio !== this.renderer.getPixelRatio();
    if (news) this.renderer.setPixelRatio(ratio);
    return news;
  }

  advance() {}
  ready() {
    return true;
  }
  pose() {}

  /** Return how many pixels a point stands back where it lies with others. */
  behind() {
    return 0;
  }

  /** Return the index of the point under the mouse, with its place on the canvas; null over none. */
  pick(event) {
    const box = this.canvas.getBoundingClientRect();
    const at = new THREE.Vector3();
    let best = null;
    this.seen().forEach((p, index) => {
      at.set(...p).project(this.camera);
      const [x, y] = [((at.x + 1) * box.width) / 2, ((1 - at.y) * box.height) / 2];
      const distance = this.behind(index) + Math.hypot(x - (event.clientX - box.left), y - (event.clientY - box.top));
      if (at.z < 1 && distance < (best?.distance ?? NEAR)) best = { index, x, y, distance };
    });
    return best;
  }

  close() {
    this.closed = true;
    this.watcher.disconnect();
    this.renderer.dispose();
  }
}
