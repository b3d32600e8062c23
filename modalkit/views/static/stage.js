// A canvas on which a structure stands: camera, light loop, and the point that the mouse is over. Drawn by three.js.

import * as THREE from "./three.module.min.js";
import { orbit } from "./orbit.js";

const NEAR = 16; // pixels within which a point is meant

/** A canvas with a camera; what is drawn says `places()`, the points that are seen, and `pose()`, how they stand. */
export class Stage {
  constructor(canvas, colours, { kept = false } = {}) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: kept });
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
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
    if (!this.dirty || !this.ready()) return;
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
