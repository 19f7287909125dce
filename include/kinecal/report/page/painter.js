// Draws solids, lines and points for the 3-D view of a report, in WebGL 2, without a library.
// SPDX-License-Identifier: Apache-2.0
const kinecalPainter = (() => {
"use strict";
const { IDENTITY, matrix, words } = kinecalScene;

// Shapes of size 1: positions and normals, three corners a triangle.
function boxShape() {
  const positions = [], normals = [];
  for (let axis = 0; axis < 3; ++axis) {
    for (const side of [-1, 1]) {
      const corner = (u, v) => {
        const p = [0, 0, 0];
        [p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]] = [side / 2, u / 2, v / 2];
        return p;
      };
      const n = [0, 0, 0];
      n[axis] = side;
      for (const [u, v] of [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]]) {
        positions.push(...corner(u, v));
        normals.push(...n);
      }
    }
  }
  return { positions, normals };
}
/// A body of revolution about z.  @param rings  [radius, z, normal's radius, normal's z]
function turnedShape(rings, segments) {
  const positions = [], normals = [];
  const corner = ([radius, z, nr, nz], k) => {
    const angle = (2 * Math.PI * k) / segments, c = Math.cos(angle), s = Math.sin(angle);
    positions.push(radius * c, radius * s, z);
    normals.push(nr * c, nr * s, nz);
  };
  for (let i = 0; i + 1 < rings.length; i += 2) {
    const [low, high] = [rings[i], rings[i + 1]];
    for (let k = 0; k < segments; ++k) {
      for (const [ring, j] of [[low, k], [low, k + 1], [high, k + 1], [low, k], [high, k + 1],
        [high, k]]) corner(ring, j);
    }
  }
  return { positions, normals };
}
function sphereShape() {
  const ring = (i) => [Math.cos(i), Math.sin(i), Math.cos(i), Math.sin(i)];
  const rings = [];
  for (let i = -8; i < 8; ++i) rings.push(ring((i * Math.PI) / 16), ring(((i + 1) * Math.PI) / 16));
  return turnedShape(rings, 32);
}
const SHAPES = {
  box: boxShape(),
  cylinder: turnedShape([[0, -0.5, 0, -1], [1, -0.5, 0, -1], [1, -0.5, 1, 0], [1, 0.5, 1, 0],
    [1, 0.5, 0, 1], [0, 0.5, 0, 1]], 40),
  sphere: sphereShape(),
};

// Shaders.
const SOLID = [`#version 300 es
  in vec3 position, normal;
  uniform mat4 camera, model;
  uniform vec3 scale;
  out vec3 world, across;
  void main() {
    vec4 p = model * vec4(position, 1.0);
    world = p.xyz;
    across = mat3(model) * (normal / (scale * scale));
    gl_Position = camera * p;
  }`, `#version 300 es
  precision highp float;
  in vec3 world, across;
  uniform vec3 eye, color;
  uniform bool ghost;
  out vec4 pixel;
  void main() {
    vec3 facet = cross(dFdx(world), dFdy(world));
    vec3 n = normalize(dot(across, across) > 0.0 ? across : facet), to_eye = normalize(eye - world);
    if (dot(n, to_eye) < 0.0) n = -n;
    float facing = dot(n, to_eye);
    float alpha = mix(0.6, 0.16, smoothstep(0.0, 0.6, facing));
    float light = 0.38 + 0.34 * max(dot(n, normalize(vec3(0.3, -0.5, 0.8))), 0.0) + 0.3 * facing;
    pixel = ghost ? vec4(color * alpha, alpha) : vec4(color * light, 1.0);
  }`];
const LINES = [`#version 300 es
  in vec2 corner;
  in vec3 from, to;
  in vec4 color;
  in float width;
  uniform mat4 camera;
  uniform vec2 viewport;
  uniform float near;
  out vec4 shade;
  out vec3 world;
  void main() {
    vec4 p = camera * vec4(from, 1.0), q = camera * vec4(to, 1.0);
    shade = color;
    // The part of the line before the eye, from share a to share b.
    float a = p.w < near ? (near - p.w) / (q.w - p.w) : 0.0;
    float b = q.w < near ? (near - p.w) / (q.w - p.w) : 1.0;
    if (p.w < near && q.w < near) a = b = 0.0;
    vec4 whole = q - p;
    q = p + b * whole;
    p = p + a * whole;
    world = mix(from, to, mix(a, b, corner.x));
    vec2 d = (q.xy / q.w - p.xy / p.w) * viewport;
    vec2 side = length(d) > 1e-6 ? normalize(vec2(-d.y, d.x)) : vec2(0.0, 1.0);
    vec4 end = mix(p, q, corner.x);
    end.xy += side * corner.y * width / viewport * end.w;
    gl_Position = end;
  }`, `#version 300 es
  precision highp float;
  in vec4 shade;
  in vec3 world;
  uniform vec4 fade;  // centre, and the distance at which lines have vanished; 0: never
  uniform float strength;
  out vec4 pixel;
  void main() {
    float rest = fade.w > 0.0 ? 1.0 - smoothstep(0.2, 1.0, distance(world, fade.xyz) / fade.w) : 1.0;
    float alpha = shade.a * rest * strength;
    pixel = vec4(shade.rgb * alpha, alpha);
  }`];
const POINTS = [`#version 300 es
  in vec3 position;
  in vec4 color;
  in float size;
  uniform mat4 camera, model;
  out vec4 shade;
  out float diameter;
  void main() {
    gl_Position = camera * model * vec4(position, 1.0);
    gl_PointSize = abs(size);
    diameter = size;  // negative: a ring
    shade = color;
  }`, `#version 300 es
  precision highp float;
  in vec4 shade;
  in float diameter;
  uniform float strength;
  out vec4 pixel;
  void main() {
    float r = length(gl_PointCoord - 0.5) * abs(diameter), outer = abs(diameter) / 2.0;
    float cover = clamp(outer - r, 0.0, 1.0);
    if (diameter < 0.0) cover *= clamp(r - outer * 0.55, 0.0, 1.0);
    if (cover * strength < 0.02) discard;
    float alpha = shade.a * cover * strength;
    pixel = vec4(shade.rgb * alpha, alpha);
  }`];

/// A linked program, its attributes and uniforms by name.
function program(gl, [vertex, fragment], attributes) {
  const linked = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(linked, shader);
  }
  attributes.forEach((name, i) => gl.bindAttribLocation(linked, i, name));
  gl.linkProgram(linked);
  if (!gl.getProgramParameter(linked, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(linked));
  const uniforms = {};
  const count = gl.getProgramParameter(linked, gl.ACTIVE_UNIFORMS);
  for (let i = 0; i < count; ++i) {
    const { name } = gl.getActiveUniform(linked, i);
    uniforms[name] = gl.getUniformLocation(linked, name);
  }
  return { linked, uniforms };
}

/// Draws solids, lines and points.
class Painter {
  constructor(gl, meshes) {
    this.gl = gl;
    this.solid = program(gl, SOLID, ["position", "normal"]);
    this.line = program(gl, LINES, ["corner", "from", "to", "color", "width"]);
    this.point = program(gl, POINTS, ["position", "color", "size"]);
    this.shapes = {};
    for (const [kind, s] of Object.entries(SHAPES)) {
      this.shapes[kind] = this.#upload(new Float32Array(s.positions), new Float32Array(s.normals));
    }
    this.meshes = meshes.map((m) => {
      const vertices = words(Float32Array, m?.vertices), triangles = words(Uint32Array, m?.triangles);
      const count = Math.floor(vertices.length / 3);
      const broken = triangles.some((i) => i >= count) || vertices.some((v) => !Number.isFinite(v));
      return broken || triangles.length < 3 ? null : this.#upload(vertices, null, triangles);
    });
    this.corners = this.#buffer(new Float32Array([0, -1, 1, -1, 0, 1, 1, 1]));
    this.scratch = gl.createBuffer();
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }
  #buffer(data, target = this.gl.ARRAY_BUFFER) {
    const buffer = this.gl.createBuffer();
    this.gl.bindBuffer(target, buffer);
    this.gl.bufferData(target, data, this.gl.STATIC_DRAW);
    return buffer;
  }
  #upload(positions, normals, triangles) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    positions.forEach((v, i) => {
      low[i % 3] = Math.min(low[i % 3], v);
      high[i % 3] = Math.max(high[i % 3], v);
    });
    return { low, high, positions: this.#buffer(positions), normals: normals && this.#buffer(normals),
      triangles: triangles && this.#buffer(triangles, this.gl.ELEMENT_ARRAY_BUFFER),
      count: triangles ? triangles.length - (triangles.length % 3) : positions.length / 3 };
  }
  /// A pass for one picture.  @param view  {camera: matrix, eye, near, viewport}
  begin(view, background) {
    const { gl } = this;
    this.view = view;
    gl.viewport(0, 0, ...view.viewport);
    gl.clearColor(...background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }
  #use({ linked, uniforms }, divisors, sizes) {
    const { gl } = this;
    gl.useProgram(linked);
    gl.uniformMatrix4fv(uniforms.camera, false, this.view.camera);
    for (let i = 0; i < 5; ++i) {
      if (sizes[i]) gl.enableVertexAttribArray(i);
      else gl.disableVertexAttribArray(i);
      gl.vertexAttribDivisor(i, divisors);
    }
    return uniforms;
  }
  /// @param solids  [{shape, pose, scale, color}]
  solids(solids, ghost) {
    const { gl } = this, uniforms = this.#use(this.solid, 0, [3, 3]);
    gl.uniform3fv(uniforms.eye, this.view.eye);
    gl.uniform1i(uniforms.ghost, ghost ? 1 : 0);
    for (const { shape, pose, scale, color } of solids) {
      gl.uniformMatrix4fv(uniforms.model, false, matrix(pose, scale));
      gl.uniform3fv(uniforms.scale, scale);
      gl.uniform3fv(uniforms.color, color);
      gl.bindBuffer(gl.ARRAY_BUFFER, shape.positions);
      gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
      if (shape.normals) {
        gl.enableVertexAttribArray(1);
        gl.bindBuffer(gl.ARRAY_BUFFER, shape.normals);
        gl.vertexAttribPointer(1, 3, gl.FLOAT, false, 0, 0);
      } else {
        gl.disableVertexAttribArray(1);
        gl.vertexAttrib3f(1, 0, 0, 0);
      }
      if (shape.triangles) {
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, shape.triangles);
        gl.drawElements(gl.TRIANGLES, shape.count, gl.UNSIGNED_INT, 0);
      } else {
        gl.drawArrays(gl.TRIANGLES, 0, shape.count);
      }
    }
  }
  /// Translucent; where its surfaces lie behind one another, only the first one is drawn.
  ghosts(solids) {
    const { gl } = this;
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 2);
    gl.colorMask(false, false, false, false);
    this.solids(solids, true);
    gl.colorMask(true, true, true, true);
    gl.enable(gl.BLEND);
    this.solids(solids, true);
    gl.disable(gl.BLEND);
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }
  #pointers(sizes) {
    const { gl } = this, stride = 4 * sizes.reduce((a, b) => a + b);
    let offset = 0;
    const first = sizes.length === 4 ? 1 : 0;  // the corners of lines have a buffer of their own
    sizes.forEach((size, i) => {
      gl.vertexAttribPointer(i + first, size, gl.FLOAT, false, stride, offset);
      offset += 4 * size;
    });
    return stride / 4;
  }
  /// @param data  11 numbers a line: from, to, colour and alpha, width in pixels
  lines(data, { strength = 1, fade = [0, 0, 0, 0] } = {}) {
    if (!data.length) return;
    const { gl } = this, uniforms = this.#use(this.line, 1, [2, 3, 3, 4, 1]);
    gl.uniform2fv(uniforms.viewport, this.view.viewport);
    gl.uniform1f(uniforms.near, this.view.near);
    gl.uniform4fv(uniforms.fade, fade);
    gl.uniform1f(uniforms.strength, strength);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.corners);
    gl.vertexAttribDivisor(0, 0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.scratch);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(data), gl.DYNAMIC_DRAW);
    const each = this.#pointers([3, 3, 4, 1]);
    gl.enable(gl.BLEND);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, data.length / each);
    gl.disable(gl.BLEND);
  }
  /// @param data  8 numbers a point: position, colour and alpha, diameter in pixels (negative: a ring)
  points(data, { strength = 1, pose = IDENTITY } = {}) {
    if (!data.length) return;
    const { gl } = this, uniforms = this.#use(this.point, 0, [3, 4, 1]);
    gl.uniformMatrix4fv(uniforms.model, false, matrix(pose));
    gl.uniform1f(uniforms.strength, strength);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.scratch);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(data), gl.DYNAMIC_DRAW);
    const each = this.#pointers([3, 4, 1]);
    gl.enable(gl.BLEND);
    gl.drawArrays(gl.POINTS, 0, data.length / each);
    gl.disable(gl.BLEND);
  }
  /// Draws with depth, then faintly what is hidden.
  throughSolids(draw) {
    const { gl } = this;
    draw(1);
    gl.disable(gl.DEPTH_TEST);
    draw(0.3);
    gl.enable(gl.DEPTH_TEST);
  }
}

return { Painter };
})();
