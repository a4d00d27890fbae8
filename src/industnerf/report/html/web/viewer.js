"use strict";
// The linked viewer: two clouds of one part under one camera.  Clouds lie in the page as base64,
// a JSON element a part, and are decoded when the part is chosen.

function bytesOf(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

const WIDE = new Set(["place", "view"]); // 16 bits a number, the others have 8

function decode(packed, scene) {
  const cloud = { says: packed.says, failed: packed.failed, count: packed.count };
  for (const [name, text] of Object.entries(packed.arrays)) {
    const bytes = bytesOf(text);
    cloud[name] = WIDE.has(name) ? new Uint16Array(bytes.buffer) : bytes;
  }
  if (cloud.place) {
    cloud.place = Float32Array.from(cloud.place, (n) => (n / 65535 - 0.5) * scene.span);
  }
  return cloud;
}

function startViewer(root) {
  const canvas = root.querySelector("canvas");
  const painter = newPainter(canvas);
  if (!painter) {
    root.querySelector("#legend").textContent =
      "This browser draws no WebGL 2: the contact sheet below shows the same clouds.";
    return;
  }
  const facts = JSON.parse(document.getElementById("looks").textContent);
  const look = { maps: {}, coloring: "error" };
  for (const [name, text] of Object.entries(facts.maps)) look.maps[name] = bytesOf(text);
  const camera = newCamera();
  const sides = ["left", "right"].map((name) => root.querySelector(`.pane.${name}`));
  let scene = null;
  let shown = [null, null];

  const redraw = () => {
    fitTo(painter, canvas);
    draw(painter, shown, camera, scene.disc);
  };

  const cloudOf = (name) => {
    scene.clouds[name] ??= decode(scene.packed[name], scene);
    return scene.clouds[name];
  };

  // Distance of the truth is to the other side's cloud: what that one misses.
  const onSide = (names, i) => {
    const cloud = cloudOf(names[i]);
    if (names[i] !== "truth" || names[1 - i] === "truth") return cloud;
    const { missed } = cloudOf(names[1 - i]);
    const asked = missed && look.coloring === "error";
    return asked ? { ...cloud, error: missed, says: `${cloud.says}: what ${names[1 - i]} misses` } : cloud;
  };

  const show = () => {
    look.limit_mm = Number(root.querySelector("[name=limit]").value) * scene.diagonal_mm;
    const names = sides.map((side) => side.querySelector("select").value);
    for (const points of shown) if (points) forget(painter, points);
    shown = sides.map((side, i) => {
      const cloud = onSide(names, i);
      const says = side.querySelector(".says");
      says.classList.toggle("failed", Boolean(cloud.failed));
      says.textContent = cloud.failed ? `failed: ${cloud.failed}` : cloud.says;
      if (!cloud.place) return null;
      const { colors, why } = colorsOf(cloud, scene, look);
      if (why) says.textContent += `; ${why}`;
      const points = newPoints(painter, cloud.place);
      paint(painter, points, colors);
      return points;
    });
    root.querySelector("#legend").innerHTML = legendOf(look);
    redraw();
  };

  const open = (id) => {
    scene = JSON.parse(document.getElementById(`scene=${id}`).textContent);
    scene.clouds = {};
    for (const option of root.querySelector("[name=limit]").options) {
      option.textContent = `${(option.value * scene.diagonal_mm).toPrecision(3)} mm`;
    }
    root.querySelector("[name=part]").value = id;
    root.querySelector("#more").href = `#part=${encodeURIComponent(id)}`;
    show();
  };

  root.addEventListener("change", (event) => {
    if (event.target.name === "part") return open(event.target.value);
    if (event.target.name === "coloring") look.coloring = event.target.value;
    return show();
  });
  document.addEventListener("click", (event) => {
    const link = event.target.closest("[data-scene]");
    if (link) open(link.dataset.scene);
  });
  followHand(canvas, camera, redraw);
  new ResizeObserver(redraw).observe(canvas);
  open(root.querySelector("[name=part]").value);
}

const viewer = document.getElementById("viewer");
if (viewer) startViewer(viewer);
