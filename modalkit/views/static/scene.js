// A structure that moves: points, lines, surfaces and directions, drawn by three.js.

import * as THREE from "./three.module.min.js";
import { Body, mesh } from "./body.js";
import { Stage } from "./stage.js";

/** Return the models of a page of shapes, that of the study first; those on its surface get it. */
export function models(page) {
  if (!page.model) return [];
  return [page.model, ...page.changed.map((one) => ({ ...one, surface: one.surface ?? page.model.surface }))];
}

/** Directions to look from, by name: turn about z and height above the x-y plane [rad]. */
export const VIEWS = {
  oblique: [-0.9, 0.5],
  "top (x-y)": [-Math.PI / 2, 1.55],
  "front (x-z)": [-Math.PI / 2, 0],
  "side (y-z)": [0, 0],
};

/** A structure that moves in its modes. */
export class Scene extends Stage {
  constructor(canvas, colours, options) {
    super(canvas, colours, options);
    this.playing = true;
    this.phase = 0;
    this.speed = 0.8;
    this.amplitude = 1;
  }

  recolour(colours) {
    super.recolour(colours);
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
  }

  /** Show a page of shapes; the camera is aimed at its points. */
  show(page) {
    this.page = page;
    this.scene.clear();
    this.group = new THREE.Group();
    this.beside = new THREE.Group();
    this.arrows = new THREE.Group();
    this.rest = new THREE.Group();
    this.pointed = new THREE.Group();
    this.scene.add(this.group, this.beside, this.arrows, this.rest, this.pointed);
    this.marker = new Body(this.pointed, [[0, 0, 0]], { size: 16, through: true });
    this.marked = null;
    const resting = new Body(this.rest, page.places, { lines: page.lines, size: 4 });
    resting.move(page.modes[0].re, null, 1, 0, 0, () => 0, this.model);
    const dots = page.nodes.length - page.still;
    this.test = new Body(this.group, page.places, { lines: page.lines, faces: page.faces, dots, opacity: 0.75 });
    this.models = models(page).map((model) => this.drawn(model));
    this.measure([...page.places, ...this.models.flatMap((one) => one.places)]);
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

  /** Draw a model on its own surface, or where it has none at the test's points; hidden until it is chosen. */
  drawn(model) {
    const group = new THREE.Group();
    group.visible = false;
    this.beside.add(group);
    const { page } = this;
    const surface = model.surface;
    const body = surface
      ? new Body(group, surface.places, surface.shape ? mesh(surface.shape) : { ...surface, dots: false, opacity: 0.4 })
      : new Body(group, page.places, { lines: page.lines, faces: page.faces, opacity: 0.4, size: 4 });
    return { body, group, along: surface?.along, places: surface?.places ?? page.places };
  }

  choose(mode, options) {
    this.mode = mode;
    this.options = options;
    this.arrows.visible = options.arrows;
    this.rest.visible = options.rest;
    const shape = this.page.modes[mode];
    this.largest = Math.max(1e-300, ...shape.re.map((v, i) => Math.hypot(...v, ...shape.im[i])));
    this.partner = models(this.page)[options.which]?.modes[mode] ?? null;
    this.fem = this.models[options.which] ?? null;
    this.models.forEach((one) => {
      one.group.visible = one === this.fem;
    });
    this.beside.visible = Boolean(this.partner) && options.model !== "no";
    if (this.only) this.beside.visible = false;
    for (const one of this.group.children) one.visible = !(this.only && one.isMesh);
    this.apart = options.model === "beside" ? this.offset() : [0, 0, 0];
    this.beside.position.set(...this.apart);
    this.surfaceShape = null;
    if (this.partner) {
      const along = this.fem.along;
      this.surfaceShape = along
        ? this.partner.surface.map((w) => along.map((a) => a * w))
        : (this.partner.surface ?? this.partner.at_points);
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

  /** Look from one of the usual directions. */
  look(name) {
    this.orbit.look(...VIEWS[name]);
    this.aim();
  }

  aim() {
    const apart = this.beside.visible ? (this.apart ?? [0, 0, 0]) : [0, 0, 0];
    const centre = this.centre.map((v, k) => v + apart[k] / 2);
    const reach = 0.09 * this.size;
    const places = [
      ...this.page.places,
      ...(this.fem?.places ?? this.page.places).map((p) => p.map((v, k) => v + apart[k])),
    ];
    this.aimAt(centre, places, reach);
  }

  advance(step) {
    if (!this.playing) return;
    this.phase += 2 * Math.PI * this.speed * step;
    this.dirty = true;
  }

  ready() {
    return this.mode !== undefined;
  }

  /** Return where the test's points are at this moment. */
  seen() {
    const at = this.test?.positions ?? [];
    return (this.page?.places ?? []).map((_, i) => [at[3 * i], at[3 * i + 1], at[3 * i + 2]]);
  }

  pose() {
    const shape = this.page.modes[this.mode];
    const [cos, sin] = [Math.cos(this.phase), Math.sin(this.phase)];
    const scale = (0.11 * this.size * this.amplitude) / this.largest;
    const difference = this.options.difference && this.partner ? this.partner.difference : null;
    const at = (i) => {
      const [r, m] = [shape.re[i], shape.im[i]];
      const k = [0, 1, 2].reduce((a, b) => (Math.hypot(r[b], m[b]) > Math.hypot(r[a], m[a]) ? b : a), 0);
      return (r[k] * cos - m[k] * sin) / this.largest;
    };
    if (difference)
      this.test.move(shape.re, shape.im, cos, sin, scale, (i) => Math.min(1, difference[i] / 0.3), this.good);
    else this.test.move(shape.re, shape.im, cos, sin, scale, at, this.shades);
    this.pointed.visible = this.marked !== null;
    if (this.pointed.visible) {
      this.marker.places = [this.seen()[this.marked]];
      this.marker.move([[0, 0, 0]], null, 1, 0, 0, () => 1, this.shades);
    }
    if (this.beside.visible && this.surfaceShape) {
      const w = this.surfaceShape;
      const own = (i) => {
        const v = w[i];
        const k = [0, 1, 2].reduce((a, b) => (Math.abs(v[b]) > Math.abs(v[a]) ? b : a), 0);
        return (v[k] * cos) / this.largest;
      };
      this.fem.body.move(
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

  /** Show points and lines of the test alone, to be drawn at, or all. */
  alone(on) {
    this.only = on;
    this.choose(this.mode, this.options);
  }

  /** Mark a point of the test; null for none. */
  mark(index) {
    this.marked = index;
    this.dirty = true;
  }

  /** Go on, or stand still where the mode is at its largest. */
  play(on) {
    this.playing = on;
    if (!on) this.phase = 0;
    this.dirty = true;
  }
}
