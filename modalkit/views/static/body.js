// What moves in a scene: points, the lines and surfaces between them, and their colours.

import * as THREE from "./three.module.min.js";

/** Colours between those of one sign and the other, through that of nothing; t from -1 to 1. */
function between(low, middle, high, t, into) {
  into.copy(middle).lerp(t < 0 ? low : high, Math.min(1, Math.abs(t)));
}

/** Return the picture of a round point, made once. */
let round = null;
function disc() {
  if (round) return round;
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 32;
  const pen = canvas.getContext("2d");
  pen.fillStyle = "#fff";
  pen.arc(16, 16, 15, 0, 2 * Math.PI);
  pen.fill();
  round = new THREE.CanvasTexture(canvas);
  return round;
}

/** One set of points that moves, with what joins them. */
export class Body {
  constructor(group, places, { lines = [], faces = [], dots = true, opacity = 0.5, size = 8, through = false } = {}) {
    this.places = places;
    this.count = places.length;
    this.positions = new Float32Array(3 * this.count);
    this.colours = new Float32Array(3 * this.count).fill(0.5);
    const shared = {
      position: new THREE.BufferAttribute(this.positions, 3),
      color: new THREE.BufferAttribute(this.colours, 3),
    };
    this.shared = shared;
    const geometry = (index) => {
      const made = new THREE.BufferGeometry();
      made.setAttribute("position", shared.position);
      made.setAttribute("color", shared.color);
      if (index) made.setIndex(index);
      return made;
    };
    const add = (object) => {
      object.frustumCulled = false;
      group.add(object);
    };
    if (faces.length) {
      const triangles = faces.flatMap((f) => (f.length === 4 ? [f[0], f[1], f[2], f[0], f[2], f[3]] : f));
      add(
        new THREE.Mesh(
          geometry(triangles),
          new THREE.MeshBasicMaterial({
            vertexColors: true,
            side: THREE.DoubleSide,
            transparent: opacity < 1,
            opacity,
            depthWrite: opacity === 1, // what is seen through hides nothing, in whatever order it is drawn
            polygonOffset: true,
            polygonOffsetFactor: 1,
            polygonOffsetUnits: 1,
          }),
        ),
      );
    }
    if (lines.length)
      add(new THREE.LineSegments(geometry(lines.flat()), new THREE.LineBasicMaterial({ vertexColors: true })));
    const seen = dots === true ? this.count : Number(dots); // the first so many of the points, or all
    if (seen)
      add(
        new THREE.Points(
          geometry([...Array(seen).keys()]),
          new THREE.PointsMaterial({
            size, // of the page's pixels: three.js multiplies by those drawn per pixel
            sizeAttenuation: false,
            vertexColors: true,
            map: disc(),
            alphaTest: 0.5,
            depthTest: !through, // or it is seen through all that stands before it
          }),
        ),
      );
  }

  /** Move every point by re cos - im sin, and colour it by a value from -1 to 1. */
  move(re, im, cos, sin, scale, value, shades) {
    const { positions, colours, places } = this;
    const shade = (this.shade ??= new THREE.Color());
    for (let i = 0; i < this.count; i += 1) {
      for (let k = 0; k < 3; k += 1)
        positions[3 * i + k] = places[i][k] + scale * (re[i][k] * cos - (im ? im[i][k] : 0) * sin);
      between(shades.low, shades.middle, shades.high, value(i), shade);
      colours[3 * i] = shade.r;
      colours[3 * i + 1] = shade.g;
      colours[3 * i + 2] = shade.b;
    }
    this.shared.position.needsUpdate = true;
    this.shared.color.needsUpdate = true;
  }
}

/** Return lines and faces of the model's own grid: [n] along a beam, [rows, columns] over a plate. */
export function mesh(shape) {
  if (shape.length === 1) return { lines: Array.from({ length: shape[0] - 1 }, (_, i) => [i, i + 1]), dots: false };
  const [rows, columns] = shape;
  const at = (r, c) => r * columns + c;
  const [lines, faces] = [[], []];
  for (let r = 0; r < rows; r += 1) {
    for (let c = 0; c < columns; c += 1) {
      if (c + 1 < columns && r % 2 === 0) lines.push([at(r, c), at(r, c + 1)]);
      if (r + 1 < rows && c % 2 === 0) lines.push([at(r, c), at(r + 1, c)]);
      if (c + 1 < columns && r + 1 < rows) faces.push([at(r, c), at(r, c + 1), at(r + 1, c + 1), at(r + 1, c)]);
    }
  }
  return { lines, faces, dots: false, opacity: 0.35 };
}
