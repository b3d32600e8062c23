// A structure that stands still: its regions coloured by a probability, its test points, and the places found.

import * as THREE from "./three.module.min.js";
import { Body } from "./body.js";
import { fill, h, palette } from "./dom.js";
import { Stage } from "./stage.js";

class Standing extends Stage {
  show(page) {
    this.page = page;
    this.scene.clear();
    const group = new THREE.Group();
    const still = page.places.map(() => [0, 0, 0]);
    const dots = !page.faces.length; // bars are a pixel thick: their nodes carry the colour
    const body = new Body(group, page.places, { lines: page.lines, faces: page.faces, dots, opacity: 1, size: 11 });
    const shade = (name) => new THREE.Color(this.colours[name]);
    const shades = { low: shade("middle"), middle: shade("middle"), high: shade("blue") };
    body.move(still, null, 1, 0, 0, (i) => Math.max(0, page.values[i] ?? 0), shades);
    this.add(group, page.places, "muted", 1, { lines: page.edges, dots: false });
    this.measure([...page.places, ...page.points.map((p) => p.place)]);
    this.add(
      group,
      page.points.map((p) => p.place),
      "ink",
      4,
    );
    this.add(group, page.found, "orange", 13, { through: true });
    for (const point of page.points.filter((p) => p.to)) group.add(this.arrow(point));
    this.scene.add(group);
    this.resize();
    this.dirty = true;
  }

  add(group, places, name, size, more = {}) {
    if (!places.length) return;
    const colour = new THREE.Color(this.colours[name]);
    const one = { low: colour, middle: colour, high: colour };
    new Body(group, places, { size, ...more }).move(
      places.map(() => [0, 0, 0]),
      null,
      1,
      0,
      0,
      () => 0,
      one,
    );
  }

  arrow({ place, to }) {
    const [long, head, wide] = [0.045, 0.012, 0.007].map((part) => part * this.size);
    return new THREE.ArrowHelper(
      new THREE.Vector3(...to).normalize(),
      new THREE.Vector3(...place),
      long,
      this.colours.green,
      head,
      wide,
    );
  }

  ready() {
    return Boolean(this.page);
  }

  aim() {
    this.aimAt(this.centre, [...this.page.places, ...this.page.points.map((p) => p.place)], 0.05 * this.size);
  }

  behind(index) {
    return index < this.page.points.length + this.page.found.length ? 0 : 4;
  }

  seen() {
    return this.page ? [...this.page.points.map((p) => p.place), ...this.page.found, ...this.page.places] : [];
  }
}

/** Put a structure into an element. Returns {show(page), recolour(), close()}. */
export function structure(root, options) {
  const canvas = h("canvas", {
    tabindex: "0",
    role: "img",
    "aria-label":
      "the structure, its regions coloured by probability; arrow keys turn it, plus and minus zoom",
  });
  const tip = h("div", { class: "tip", hidden: true });
  const frame = h("div", { class: "canvas" }, canvas, tip);
  root.append(frame);
  const stage = new Standing(canvas, palette(), options);
  let page = null;
  const show = (given) => {
    page = given;
    stage.recolour(palette());
    stage.show(page);
  };
  canvas.addEventListener("pointermove", (event) => {
    const found = event.buttons ? null : stage.pick(event);
    tip.hidden = !found;
    if (!found) return;
    fill(tip, named(page, found.index));
    tip.style.left = `${Math.max(4, Math.min(found.x + 12, frame.clientWidth - tip.offsetWidth - 4))}px`;
    tip.style.top = `${found.y + 12}px`;
  });
  canvas.addEventListener("pointerleave", () => {
    tip.hidden = true;
  });
  return { show, recolour: () => page && show(page), close: () => stage.close() };
}

/** Return what is known of a point: of the test, of the places found, or of the mesh. */
function named(page, index) {
  const at = (place) => place.map((v) => v.toPrecision(4)).join(", ");
  if (index < page.points.length) return `${page.points[index].name} at ${at(page.points[index].place)} m`;
  const place = index - page.points.length;
  if (place < page.found.length) return `place found: ${at(page.found[place])} m`;
  const node = place - page.found.length;
  const held = page.values[node];
  const share = held === null ? "" : `: ${(100 * held).toFixed(1)} %`;
  return `${page.regions[node] || "no region"}${share} at ${at(page.places[node])} m`;
}
