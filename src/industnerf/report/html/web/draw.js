"use strict";
// Points as round discs with WebGL 2, then a pass that darkens a pixel the further its neighbors
// stand before it: eye-dome lighting, for clouds have no normals, but depth alone shows form.

const DISC_SHADER = [`#version 300 es
  in vec3 position;
  in vec3 color;
  uniform mat4 camera;
  uniform float disc; // diameter of a disc at depth 1, px
  out vec3 vertexColor;
  void main() {
    gl_Position = camera * vec4(position, 1.0);
    gl_PointSize = max(2.0, disc / gl_Position.w);
    vertexColor = color;
  }`, `#version 300 es
  precision mediump float;
  in vec3 vertexColor;
  out vec4 pixel;
  void main() {
    vec2 from = gl_PointCoord - 0.5;
    if (dot(from, from) > 0.25) discard;
    pixel = vec4(vertexColor, 1.0);
  }`];

const EDL_SHADER = [`#version 300 es
  void main() { // one triangle over the whole canvas
    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
  }`, `#version 300 es
  precision highp float;
  uniform sampler2D colors;
  uniform highp sampler2D depths;
  uniform vec2 range; // near and far
  uniform int reach; // px
  out vec4 pixel;
  float logDepth(ivec2 at) {
    float depth = texelFetch(depths, clamp(at, ivec2(0), textureSize(depths, 0) - 1), 0).r;
    if (depth == 1.0) return 0.0; // nothing there
    float z = 2.0 * depth - 1.0;
    return log2(2.0 * range.x * range.y / (range.y + range.x - z * (range.y - range.x)));
  }
  void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 here = texelFetch(colors, at, 0);
    if (here.a == 0.0) { pixel = vec4(1.0); return; }
    float mine = logDepth(at), occlusion = 0.0;
    for (int i = 0; i < 9; i++) {
      ivec2 neighbor = at + reach * ivec2(i % 3 - 1, i / 3 - 1);
      float other = logDepth(neighbor);
      if (other != 0.0) occlusion += min(max(0.0, mine - other), 0.05);
    }
    pixel = vec4(here.rgb * exp(-4.0 * occlusion), 1.0);
  }`];

function compile(gl, [vertex, fragment]) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    throw new Error(`shader: ${gl.getProgramInfoLog(program)}`);
  }
  return program;
}

// Null where the browser has no WebGL 2.
function newRenderer(canvas) {
  const gl = canvas.getContext("webgl2", { antialias: false, preserveDrawingBuffer: true });
  if (!gl) return null;
  return { gl, disc: compile(gl, DISC_SHADER), edl: compile(gl, EDL_SHADER), width: 0, height: 0 };
}

// The textures that the points are drawn to, as large as the canvas.
function resize(renderer, canvas) {
  const { gl } = renderer;
  const scale = Math.min(2, window.devicePixelRatio);
  const width = Math.round(canvas.clientWidth * scale);
  const height = Math.round(canvas.clientHeight * scale);
  if (renderer.width === width && renderer.height === height) return;
  Object.assign(renderer, { width, height, scale });
  Object.assign(canvas, { width, height });
  for (const texture of [renderer.colors, renderer.depths]) gl.deleteTexture(texture);
  gl.deleteFramebuffer(renderer.frame);
  renderer.colors = texture(gl, gl.RGBA8, width, height);
  renderer.depths = texture(gl, gl.DEPTH_COMPONENT24, width, height);
  renderer.frame = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, renderer.frame);
  const attach = (where, what) =>
    gl.framebufferTexture2D(gl.FRAMEBUFFER, where, gl.TEXTURE_2D, what, 0);
  attach(gl.COLOR_ATTACHMENT0, renderer.colors);
  attach(gl.DEPTH_ATTACHMENT, renderer.depths);
}

function texture(gl, kind, width, height) {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texStorage2D(gl.TEXTURE_2D, 1, kind, width, height);
  for (const how of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
    gl.texParameteri(gl.TEXTURE_2D, how, gl.NEAREST);
  }
  return made;
}

// `positions`: Float32Array, three numbers a point; `colors`: Uint8Array, three numbers a point.
function newPoints({ gl, disc }, positions) {
  const points = { count: positions.length / 3, layout: gl.createVertexArray(), colors: gl.createBuffer() };
  gl.bindVertexArray(points.layout);
  const attribute = (name, buffer, kind, normalized) => {
    const where = gl.getAttribLocation(disc, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(where);
    gl.vertexAttribPointer(where, 3, kind, normalized, 0, 0);
  };
  attribute("color", points.colors, gl.UNSIGNED_BYTE, true);
  points.positions = gl.createBuffer();
  attribute("position", points.positions, gl.FLOAT, false);
  gl.bufferData(gl.ARRAY_BUFFER, positions, gl.STATIC_DRAW);
  return points;
}

function uploadColors({ gl }, points, colors) {
  gl.bindBuffer(gl.ARRAY_BUFFER, points.colors);
  gl.bufferData(gl.ARRAY_BUFFER, colors, gl.DYNAMIC_DRAW);
}

function deletePoints({ gl }, points) {
  gl.deleteVertexArray(points.layout);
  gl.deleteBuffer(points.positions);
  gl.deleteBuffer(points.colors);
}

// Draw sets of points, each of which may be null, side by side; `size` of a disc in diagonals.
function draw(renderer, panes, camera, size) {
  const { gl, width, height } = renderer;
  const part = Math.floor(width / panes.length);
  const matrix = matrixOf(camera, part / height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, renderer.frame);
  gl.viewport(0, 0, width, height);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST);
  gl.useProgram(renderer.disc);
  gl.uniformMatrix4fv(gl.getUniformLocation(renderer.disc, "camera"), false, matrix);
  const pixels = (size * height * Math.min(1, part / height)) / (2 * OPENING);
  gl.uniform1f(gl.getUniformLocation(renderer.disc, "disc"), pixels);
  gl.enable(gl.SCISSOR_TEST); // a disc may reach over the edge of its pane
  panes.forEach((points, i) => {
    if (!points) return;
    gl.viewport(i * part, 0, part, height);
    gl.scissor(i * part, 0, part, height);
    gl.bindVertexArray(points.layout);
    gl.drawArrays(gl.POINTS, 0, points.count);
  });
  gl.disable(gl.SCISSOR_TEST);
  applyEyeDomeLighting(renderer);
}

function applyEyeDomeLighting(renderer) {
  const { gl, width, height, edl } = renderer;
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.viewport(0, 0, width, height);
  gl.disable(gl.DEPTH_TEST);
  gl.useProgram(edl);
  [renderer.colors, renderer.depths].forEach((texture, i) => {
    gl.activeTexture(gl.TEXTURE0 + i);
    gl.bindTexture(gl.TEXTURE_2D, texture);
  });
  gl.uniform1i(gl.getUniformLocation(edl, "colors"), 0);
  gl.uniform1i(gl.getUniformLocation(edl, "depths"), 1);
  gl.uniform2f(gl.getUniformLocation(edl, "range"), NEAR, FAR);
  gl.uniform1i(gl.getUniformLocation(edl, "reach"), Math.round(renderer.scale));
  gl.bindVertexArray(null);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}
