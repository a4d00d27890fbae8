"use strict";
// The linked viewer: clouds of one part side by side under one camera, most often two.  Clouds lie
// in the page as compressed base64, a JSON element a part, and are decoded when they are chosen.

function decodeBase64(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

async function inflate(text) {
  const packed = new Blob([decodeBase64(text)]).stream();
  const stream = packed.pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const WIDE = new Set(["positions", "view", "deviation"]); // 16 bits a number, the others have 8
const STEPS = 2 ** 14 - 1; // of positions

// All low bytes, then all high ones.
function joinBytes(bytes) {
  const half = bytes.length / 2;
  return Uint16Array.from({ length: half }, (_, i) => bytes[i] | (bytes[half + i] << 8));
}

// Of three rows of differences, the points.
function sumUp(differences, scene) {
  const count = differences.length / 3;
  const positions = new Float32Array(3 * count);
  for (let axis = 0; axis < 3; axis++) {
    let step = 0;
    for (let i = 0; i < count; i++) {
      step = (step + differences[axis * count + i]) & 0xffff;
      positions[3 * i + axis] = (step / STEPS - 0.5) * scene.span;
    }
  }
  return positions;
}

async function decode(packed, scene) {
  const cloud = { caption: packed.caption, failed: packed.failed, count: packed.count };
  for (const [name, text] of Object.entries(packed.arrays)) {
    const bytes = await inflate(text);
    cloud[name] = WIDE.has(name) ? joinBytes(bytes) : bytes;
  }
  if (cloud.positions) cloud.positions = sumUp(cloud.positions, scene);
  return cloud;
}

function startViewer(root) {
  const canvas = root.querySelector("canvas");
  const renderer = newRenderer(canvas);
  const lacks = !renderer ? "draws no WebGL 2" : !window.DecompressionStream ? "cannot unpack zlib" : "";
  if (lacks) {
    root.querySelector("#legend").textContent =
      `This browser ${lacks}: the pictures beside or below show the same clouds.`;
    return;
  }
  const first = root.querySelector("[name=coloring]:checked").value;
  const settings = { maps: {}, coloring: first };
  const colorMaps = JSON.parse(document.getElementById("color-maps").textContent);
  for (const [name, text] of Object.entries(colorMaps)) settings.maps[name] = decodeBase64(text);
  const camera = newCamera();
  const sides = [...root.querySelectorAll(".pane")];
  const limit = root.querySelector("[name=limit]");
  let scene = null;
  let shown = sides.map(() => null);

  const redraw = () => {
    resize(renderer, canvas);
    draw(renderer, shown, camera, scene.disc_diameter);
  };

  const load = async (from, names) => {
    for (const name of names) from.clouds[name] ??= await decode(from.packed[name], from);
  };

  // Distance of the truth is to the other side's cloud: what that one misses.
  const onSide = (names, i) => {
    const cloud = scene.clouds[names[i]];
    if (names[i] !== "truth" || names[1 - i] === "truth") return cloud;
    const { missed } = scene.clouds[names[1 - i]];
    const asked = missed && settings.coloring === "error";
    return asked ? { ...cloud, error: missed, caption: `${cloud.caption}: what ${names[1 - i]} misses` } : cloud;
  };

  let lastAsked = 0;
  const show = async () => {
    const asked = ++lastAsked;
    root.setAttribute("aria-busy", "true");
    settings.limit_mm = Number(limit.value) * scene.diagonal_mm;
    settings.unit = scene.unit;
    settings.tolerance_mm = scene.tolerance_mm;
    settings.has_truth = "truth" in scene.packed;
    const names = sides.map((side) => side.querySelector("select").value);
    try {
      await load(scene, names);
    } catch (error) {
      root.querySelector("#legend").textContent = `The clouds cannot be read: ${error}`;
      root.setAttribute("aria-busy", "false");
      return;
    }
    if (asked !== lastAsked) return; // something else was chosen while these were decoded
    for (const points of shown) if (points) deletePoints(renderer, points);
    shown = sides.map((side, i) => {
      const cloud = onSide(names, i);
      const caption = side.querySelector(".caption");
      caption.classList.toggle("failed", Boolean(cloud.failed));
      caption.textContent = cloud.failed ? `failed: ${cloud.failed}` : cloud.caption;
      if (!cloud.positions) return null;
      const { colors, why } = colorsOf(cloud, scene, settings);
      if (why) caption.textContent += `; ${why}`;
      const points = newPoints(renderer, cloud.positions);
      uploadColors(renderer, points, colors);
      return points;
    });
    root.querySelector("#legend").innerHTML = legendOf(settings);
    redraw();
    root.setAttribute("aria-busy", "false");
  };

  const open = (id) => {
    scene = JSON.parse(document.getElementById(`scene=${id}`).textContent);
    scene.clouds = {};
    for (const option of limit.options) {
      option.textContent = `${(option.value * scene.diagonal_mm).toPrecision(3)} ${scene.unit}`;
    }
    root.querySelector("[name=part]").value = id;
    const more = root.querySelector("#more");
    if (more) more.href = `#part=${encodeURIComponent(id)}`;
    show();
  };

  root.addEventListener("change", (event) => {
    if (event.target.name === "part") return open(event.target.value);
    if (event.target.name === "coloring") settings.coloring = event.target.value;
    return show();
  });
  document.addEventListener("click", (event) => {
    const link = event.target.closest("[data-scene]");
    if (link) open(link.dataset.scene);
  });
  attachControls(canvas, camera, redraw);
  new ResizeObserver(redraw).observe(canvas);
  open(root.querySelector("[name=part]").value);
}

const viewer = document.getElementById("viewer");
if (viewer) startViewer(viewer);
