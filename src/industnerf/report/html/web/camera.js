"use strict";
// A camera that goes round a point, and its controls.  Lengths are in diagonals of the
// part's bounding box, z is up.  Matrices are 16 numbers, column by column, as WebGL reads them.

const OPENING = Math.tan((12 * Math.PI) / 180); // half the height that the camera sees, at depth 1
const NEAR = 0.05;
const FAR = 40;

function newCamera() {
  return { turn: -0.88, rise: 0.52, distance: 2.6, center: [0, 0, 0] };
}

function axesOf(camera) {
  const { turn, rise } = camera;
  return {
    right: [-Math.sin(turn), Math.cos(turn), 0],
    up: [-Math.sin(rise) * Math.cos(turn), -Math.sin(rise) * Math.sin(turn), Math.cos(rise)],
    back: [Math.cos(rise) * Math.cos(turn), Math.cos(rise) * Math.sin(turn), Math.sin(rise)],
  };
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// From diagonals to clip space, for a pane `aspect` times as wide as it is high.
function matrixOf(camera, aspect) {
  const { right, up, back } = axesOf(camera);
  const wide = Math.min(1, aspect); // a narrow pane keeps the whole part in sight
  const [x, y] = [wide / (OPENING * aspect), wide / OPENING];
  const a = (FAR + NEAR) / (NEAR - FAR);
  const b = (2 * FAR * NEAR) / (NEAR - FAR);
  const shift = [dot(right, camera.center), dot(up, camera.center)];
  const depth = -dot(back, camera.center) - camera.distance;
  const column = (i) => [x * right[i], y * up[i], a * back[i], -back[i]];
  return [...column(0), ...column(1), ...column(2),
          -x * shift[0], -y * shift[1], a * depth + b, -depth];
}

function orbit(camera, across, down) {
  camera.turn -= across;
  camera.rise = Math.max(-1.5, Math.min(1.5, camera.rise + down));
}

function shift(camera, across, down) {
  const { right, up } = axesOf(camera);
  const scale = 2 * OPENING * camera.distance;
  camera.center = camera.center.map((c, i) => c - scale * (across * right[i] - down * up[i]));
}

function zoom(camera, factor) {
  camera.distance = Math.max(0.3, Math.min(20, camera.distance * factor));
}

const KEYS = {
  ArrowLeft: (camera) => orbit(camera, -0.1, 0),
  ArrowRight: (camera) => orbit(camera, 0.1, 0),
  ArrowUp: (camera) => orbit(camera, 0, 0.1),
  ArrowDown: (camera) => orbit(camera, 0, -0.1),
  "+": (camera) => zoom(camera, 1 / 1.15),
  "-": (camera) => zoom(camera, 1.15),
  0: (camera) => Object.assign(camera, newCamera()),
};

// Drag turns, shift-drag or the right button shifts, the wheel zooms once the canvas was clicked
// (before that it scrolls the page), a double click or the key 0 goes back to the start.
function attachControls(canvas, camera, redraw) {
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    if (!canvas.hasPointerCapture(event.pointerId)) return;
    const [across, down] = [event.movementX, event.movementY];
    if (event.shiftKey || event.buttons & 2) {
      shift(camera, across / canvas.clientHeight, down / canvas.clientHeight);
    } else {
      orbit(camera, across / 150, down / 150);
    }
    redraw();
  });
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas) return;
    event.preventDefault();
    zoom(camera, Math.exp(Math.sign(event.deltaY) * 0.12));
    redraw();
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    if (!(event.key in KEYS)) return;
    event.preventDefault();
    KEYS[event.key](camera);
    redraw();
  });
  canvas.addEventListener("dblclick", () => {
    KEYS[0](camera);
    redraw();
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
}
