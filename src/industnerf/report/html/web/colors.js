"use strict";
// What colors a cloud can be given, and the legend of each.  A cloud that does not hold what is
// asked for is gray, and says so.

const GRAY = [150, 158, 168];
const SEEN = [70, 90, 120];
const HIDDEN = [225, 150, 60];

// 256 colors, three bytes each; `share` in [0, 1].
function fromMap(map, share) {
  const at = 3 * Math.min(255, Math.max(0, Math.floor(share * 256)));
  return [map[at], map[at + 1], map[at + 2]];
}

// Hues of consecutive views lie far apart: the golden angle.
function ofView(view) {
  if (view < 0) return GRAY;
  const hue = (view * 137.508) % 360;
  const channel = (n) => {
    const k = (n + hue / 30) % 12;
    return Math.round(255 * (0.55 - 0.38 * Math.max(-1, Math.min(k - 3, 9 - k, 1))));
  };
  return [channel(0), channel(8), channel(4)];
}

// An array of three bytes a point; `color(i)` of point i.
function colorEach(count, color) {
  const colors = new Uint8Array(3 * count);
  for (let i = 0; i < count; i++) colors.set(color(i), 3 * i);
  return colors;
}

// Distances are stored as roots, for small ones matter most: 255 is `max_mm`.
function millimeters(root, max_mm) {
  return max_mm * (root / 255) ** 2;
}

// Each: what a cloud must hold, and the color of its point i.
const COLORINGS = {
  error: {
    needs: "error", lacks: "there is nothing beside it to measure to",
    of: (cloud, scene, settings) => (i) =>
      fromMap(settings.maps.error, millimeters(cloud.error[i], scene.max_error_mm) / settings.limit_mm),
  },
  // Signed: 0 is in the middle of the map.  16 bits, from -max_error_mm to max_error_mm.
  deviation: {
    needs: "deviation", lacks: "what is deviated from",
    of: (cloud, scene, settings) => (i) => {
      const mm = (cloud.deviation[i] / 32767.5 - 1) * scene.max_error_mm;
      return fromMap(settings.maps.deviation, 0.5 + mm / (2 * settings.limit_mm));
    },
  },
  height: {
    needs: "positions", lacks: "",
    of: (cloud, scene, settings) => {
      const z = (i) => cloud.positions[3 * i + 2];
      let [low, high] = [Infinity, -Infinity];
      for (let i = 0; i < cloud.count; i++) [low, high] = [Math.min(low, z(i)), Math.max(high, z(i))];
      return (i) => fromMap(settings.maps.confidence, (z(i) - low) / (high - low || 1));
    },
  },
  confidence: {
    needs: "confidence", lacks: "it states no confidence that differs between points",
    of: (cloud, scene, settings) => (i) => fromMap(settings.maps.confidence, cloud.confidence[i] / 255),
  },
  view: {
    needs: "view", lacks: "it does not say which view a point is from",
    of: (cloud) => (i) => ofView(cloud.view[i] - 1),
  },
  photo: {
    needs: "color", lacks: "its points have no colors",
    of: (cloud) => (i) => cloud.color.subarray(3 * i, 3 * i + 3),
  },
};
COLORINGS.own = COLORINGS.photo; // of a file of anybody's

// Colors of `cloud`, and why they are gray where they are.
function colorsOf(cloud, scene, settings) {
  const coloring = COLORINGS[settings.coloring];
  if (cloud.visible && settings.coloring !== "error") {
    return { colors: colorEach(cloud.count, (i) => (cloud.visible[i] ? SEEN : HIDDEN)), why: "" };
  }
  if (!cloud[coloring.needs]) {
    return { colors: colorEach(cloud.count, () => GRAY), why: coloring.lacks };
  }
  return { colors: colorEach(cloud.count, coloring.of(cloud, scene, settings)), why: "" };
}

// `marks` are shares of its length.
function ramp(map, marks = []) {
  const stops = [0, 32, 64, 96, 128, 160, 192, 224, 255].map((i) => `rgb(${map.subarray(3 * i, 3 * i + 3)})`);
  const lines = marks.map((share) => {
    const [low, high] = [`calc(${100 * share}% - 1px)`, `calc(${100 * share}% + 1px)`];
    return `linear-gradient(to right,transparent ${low},#1f2328 ${low},#1f2328 ${high},transparent ${high})`;
  });
  const layers = [...lines, `linear-gradient(to right,${stops})`];
  return `<span class="ramp" style="background:${layers}"></span>`;
}

function deviationLegend({ limit_mm, tolerance_mm, unit, maps }) {
  const end = `${limit_mm.toPrecision(3)} ${unit}`;
  if (!tolerance_mm) return `-${end} ${ramp(maps.deviation)} +${end}: outside the surface`;
  const half = tolerance_mm / (2 * limit_mm);
  return `-${end} ${ramp(maps.deviation, [0.5 - half, 0.5 + half])} +${end}: outside the surface; ` +
    `the marks are the tolerance, ${Number(tolerance_mm.toPrecision(3))} ${unit} on either side`;
}

function spot([r, g, b], text) {
  return `<span class="dot" style="background:rgb(${r},${g},${b})"></span>${text}`;
}

function legendOf(settings) {
  const truth = settings.has_truth
    ? `; truth: ${spot(SEEN, "seen by the reference rig")} ${spot(HIDDEN, "hidden from it")}` : "";
  const end = `${settings.limit_mm.toPrecision(3)} ${settings.unit}`;
  const named = {
    error: () => `0 ${ramp(settings.maps.error)} ${end} and more`,
    deviation: () => deviationLegend(settings),
    height: () => `bottom ${ramp(settings.maps.confidence)} top`,
    confidence: () => `confidence 0 ${ramp(settings.maps.confidence)} 1${truth}`,
    view: () => `each view has a color of its own, ${spot(GRAY, "view unknown")}${truth}`,
    photo: () => `as in the photographs${truth}`,
    own: () => "as the file has them",
  };
  return named[settings.coloring]();
}
