// A camera that goes round a structure: by mouse, by finger, by keys.

/** Let a canvas turn and zoom a camera about a centre. Returns {aim(centre, corners, aspect), place(), look()}. */
export function orbit(canvas, camera, changed) {
  const view = { azimuth: -0.9, height: 0.5, distance: 3, centre: [0, 0, 0], radius: 1 };
  const pointers = new Map();
  let pinch = 0;

  function place() {
    const { azimuth, height, distance, centre } = view;
    const flat = distance * Math.cos(height);
    camera.position.set(
      centre[0] + flat * Math.cos(azimuth),
      centre[1] + flat * Math.sin(azimuth),
      centre[2] + distance * Math.sin(height),
    );
    camera.near = distance / 100;
    camera.far = distance * 10 + 10 * view.radius;
    camera.lookAt(...centre);
    camera.updateProjectionMatrix();
    changed();
  }

  const turn = (dx, dy) => {
    view.azimuth -= 0.008 * dx;
    view.height = Math.min(1.55, Math.max(-1.55, view.height + 0.008 * dy));
    place();
  };
  const zoom = (factor) => {
    view.distance = Math.min(20 * view.radius, Math.max(0.3 * view.radius, view.distance * factor));
    place();
  };

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const here = [event.clientX, event.clientY];
    pointers.set(event.pointerId, here);
    if (pointers.size === 1) {
      turn(here[0] - last[0], here[1] - last[1]);
      return;
    }
    const [a, b] = [...pointers.values()];
    const apart = Math.hypot(a[0] - b[0], a[1] - b[1]);
    if (pinch) zoom(pinch / apart);
    pinch = apart;
  });
  for (const end of ["pointerup", "pointercancel"])
    canvas.addEventListener(end, (event) => {
      pointers.delete(event.pointerId);
      pinch = 0;
    });
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      zoom(Math.exp(0.0012 * event.deltaY));
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-12, 0], ArrowRight: [12, 0], ArrowUp: [0, 12], ArrowDown: [0, -12] }[event.key];
    if (step) {
      event.preventDefault();
      turn(...step);
    }
    if (event.key === "+" || event.key === "=") zoom(0.9);
    if (event.key === "-") zoom(1.1);
  });

  /** Look at a box from the direction that the camera has, as near as all its corners can be seen. */
  function aim(centre, corners, aspect) {
    const { azimuth, height } = view;
    const towards = [Math.cos(height) * Math.cos(azimuth), Math.cos(height) * Math.sin(azimuth), Math.sin(height)];
    const right = [-Math.sin(azimuth), Math.cos(azimuth), 0];
    const up = [-Math.sin(height) * Math.cos(azimuth), -Math.sin(height) * Math.sin(azimuth), Math.cos(height)];
    const tan = Math.tan((camera.fov * Math.PI) / 360);
    const along = (p, axis) => p.reduce((sum, v, k) => sum + (v - centre[k]) * axis[k], 0);
    const needed = corners.map(
      (p) => along(p, towards) + Math.max(Math.abs(along(p, right)) / (tan * aspect), Math.abs(along(p, up)) / tan),
    );
    const radius = Math.max(...corners.map((p) => Math.hypot(...p.map((v, k) => v - centre[k]))));
    Object.assign(view, { centre, radius, distance: 1.05 * Math.max(...needed) });
    place();
  }

  /** Turn the camera to a direction [rad], as seen from the structure. */
  const look = (azimuth, height) => Object.assign(view, { azimuth, height });
  return { aim, place, look };
}
