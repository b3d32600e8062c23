// A structure that moves: points, lines, surfaces and directions, drawn by three.js.

import * as THREE from "./three.module.min.js";
import { Body, mesh } from "./body.js";
import { orbit } from "./orbit.js";

/** A canvas with a structure in it. */
export class Scene {
  constructor(canvas, colours) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: false });
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.orbit = orbit(canvas, this.camera, () => {
      this.dirty = true;
    });
    this.playing = true;
    this.phase = 0;
    this.speed = 0.8;
    this.amplitude = 1;
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
    this.shades = {
      low: new THREE.Color(colours.blue),
      middle: new THREE.Color(colours.middle),
      high: new THREE.Color(colours.orange),
    };
    this.model = {
      low: new THREE.Color(colours.muted),
      middle: new THREE.Color(colours.muted),
      high: new THREE.Color(colours.muted),
    };
    this.good = {
      low: new THREE.Color(colours.green),
      middle: new THREE.Color(colours.green),
      high: new THREE.Color(colours.red),
    };
    this.dirty = true;
  }

  /** Show a page of shapes; the camera is aimed at its points. */
  show(page) {
    this.page = page;
    this.scene.clear();
    this.group = new THREE.Group();
    this.beside = new THREE.Group();
    this.arrows = new THREE.Group();
    this.scene.add(this.group, this.beside, this.arrows);
    this.test = new Body(this.group, page.places, { lines: page.lines, faces: page.faces, opacity: 0.75 });
    const surface = page.model?.surface;
    this.fem = surface
      ? new Body(this.beside, surface.places, mesh(surface.shape))
      : page.model
        ? new Body(this.beside, page.places, { lines: page.lines, faces: page.faces, opacity: 0.4, size: 4 })
        : null;
    const all = surface ? [...page.places, ...surface.places] : page.places;
    const low = [0, 1, 2].map((k) => Math.min(...all.map((p) => p[k])));
    const high = [0, 1, 2].map((k) => Math.max(...all.map((p) => p[k])));
    this.size = Math.hypot(...low.map((v, k) => high[k] - v)) || 1;
    this.spread = [0, 1, 2].map((k) => high[k] - low[k]);
    this.centre = low.map((v, k) => (v + high[k]) / 2);
    for (const arrow of page.arrows) {
      const to = new THREE.Vector3(...arrow.to);
      if (to.lengthSq() > 0)
        this.arrows.add(
          new THREE.ArrowHelper(
            to.normalize(),
            new THREE.Vector3(...page.places[arrow.node]),
            0.06 * this.size,
            this.colours.green,
            0.02 * this.size,
            0.012 * this.size,
          ),
        );
    }
    this.resize();
  }

  choose(mode, options) {
    this.mode = mode;
    this.options = options;
    this.arrows.visible = options.arrows;
    const shape = this.page.modes[mode];
    this.largest = Math.max(1e-300, ...shape.re.map((v, i) => Math.hypot(...v, ...shape.im[i])));
    const model = this.page.model?.modes[mode] ?? null;
    this.beside.visible = Boolean(model) && options.model !== "no";
    this.apart = options.model === "beside" ? this.offset() : [0, 0, 0];
    this.beside.position.set(...this.apart);
    this.surfaceShape = null;
    if (model && this.fem) {
      const along = this.page.model.surface?.along;
      this.surfaceShape = model.surface ? model.surface.map((w) => along.map((a) => a * w)) : model.at_points;
    }
    this.aim();
    this.dirty = true;
  }

  /** Stand the model beside the test along its shorter side, so that both stay large. */
  offset() {
    const k = this.spread[1] <= this.spread[0] ? 1 : 0;
    const step = [0, 0, 0];
    step[k] = Math.max(1.35 * this.spread[k], 0.3 * this.size);
    return step;
  }

  aim() {
    const apart = this.beside.visible ? (this.apart ?? [0, 0, 0]) : [0, 0, 0];
    const centre = this.centre.map((v, k) => v + apart[k] / 2);
    const reach = 0.09 * this.size;
    const places = [
      ...this.page.places,
      ...(this.page.model?.surface?.places ?? this.page.places).map((p) => p.map((v, k) => v + apart[k])),
    ];
    const corners = places.flatMap((p) =>
      [0, 1, 2].flatMap((k) => [-reach, reach].map((d) => p.map((v, i) => v + (i === k ? d : 0)))),
    );
    this.orbit.aim(centre, corners, this.camera.aspect);
  }

  resize() {
    const box = this.canvas.parentElement.getBoundingClientRect();
    if (!box.width || !this.page) return;
    this.renderer.setSize(box.width, box.height, false);
    this.camera.aspect = box.width / box.height;
    this.aim();
  }

  frame(now) {
    const step = Math.min(100, now - (this.last ?? now)) / 1000;
    this.last = now;
    if (this.playing) {
      this.phase += 2 * Math.PI * this.speed * step;
      this.dirty = true;
    }
    if (!this.dirty || this.mode === undefined) return;
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

  pose() {
    const shape = this.page.modes[this.mode];
    const model = this.page.model?.modes[this.mode] ?? null;
    const [cos, sin] = [Math.cos(this.phase), Math.sin(this.phase)];
    const scale = (0.11 * this.size * this.amplitude) / this.largest;
    const difference = this.options.difference && model ? model.difference : null;
    const at = (i) => {
      const [r, m] = [shape.re[i], shape.im[i]];
      const k = [0, 1, 2].reduce((a, b) => (Math.hypot(r[b], m[b]) > Math.hypot(r[a], m[a]) ? b : a), 0);
      return (r[k] * cos - m[k] * sin) / this.largest;
    };
    if (difference)
      this.test.move(shape.re, shape.im, cos, sin, scale, (i) => Math.min(1, difference[i] / 0.3), this.good);
    else this.test.move(shape.re, shape.im, cos, sin, scale, at, this.shades);
    if (this.beside.visible && this.surfaceShape) {
      const w = this.surfaceShape;
      const own = (i) => {
        const v = w[i];
        const k = [0, 1, 2].reduce((a, b) => (Math.abs(v[b]) > Math.abs(v[a]) ? b : a), 0);
        return (v[k] * cos) / this.largest;
      };
      this.fem.move(
        w,
        null,
        cos,
        sin,
        scale,
        this.options.model === "beside" ? own : () => 0,
        this.options.model === "beside" ? this.shades : this.model,
      );
    }
  }

  /** Go on, or stand still where the mode is at its largest. */
  play(on) {
    this.playing = on;
    if (!on) this.phase = 0;
    this.dirty = true;
  }

  close() {
    this.closed = true;
    this.watcher.disconnect();
    this.renderer.dispose();
  }
}
