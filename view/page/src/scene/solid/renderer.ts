import type { Rgba } from "../palette";
import type { Orbit, Vector } from "./orbit";

const solidVertex = `#version 300 es
layout(location=0) in vec3 point; layout(location=1) in vec3 normal; layout(location=2) in vec4 tint;
uniform mat4 view; uniform vec3 origin; out vec4 colour; out float far;
void main() {
  vec4 p = view * vec4(point - origin, 1);
  // Two lights, from above and from the side; faces are seen from both sides.
  float light = 0.62 + 0.3 * max(normal.z, 0.0) + 0.14 * abs(dot(normal, vec3(0.53, 0.85, 0)));
  colour = vec4(tint.rgb * light, tint.a); far = p.w; gl_Position = p;
}`;
const solidFragment = `#version 300 es
precision highp float; in vec4 colour; in float far; uniform vec3 sky; uniform float haze; out vec4 result;
void main() { result = vec4(mix(sky, colour.rgb, exp(-far * haze)), 1.0) * colour.a; }`;
const floorVertex = `#version 300 es
layout(location=0) in vec2 corner;
uniform mat4 view; uniform vec3 origin; uniform vec4 place; uniform vec2 extent; out vec2 uv; out float far;
void main() {
  uv = corner; vec2 q = corner * extent;
  vec4 p = view * vec4(place.xy + vec2(place.z * q.x - place.w * q.y, place.w * q.x + place.z * q.y) - origin.xy, -origin.z, 1);
  far = p.w; gl_Position = p;
}`;
const floorFragment = `#version 300 es
precision highp float; in vec2 uv; in float far; uniform sampler2D cells; uniform vec4 inside, outside; uniform vec3 sky; uniform float haze; out vec4 result;
void main() {
  float v = texture(cells, uv).r, w = max(fwidth(v), 1e-4);
  vec4 c = mix(outside, inside, smoothstep(0.5 - w, 0.5 + w, v));
  result = vec4(mix(sky, c.rgb, exp(-far * haze)), 1.0) * c.a;
}`;
const lineVertex = `#version 300 es
layout(location=0) in vec3 from; layout(location=1) in vec3 to; layout(location=2) in vec4 tint; layout(location=3) in float width;
uniform mat4 view; uniform vec3 origin; uniform vec2 size; out vec4 colour;
const float near = 0.06;
void main() {
  vec4 a = view * vec4(from - origin, 1), b = view * vec4(to - origin, 1);
  if (a.w < near && b.w > near) a = mix(a, b, (near - a.w) / (b.w - a.w));
  if (b.w < near && a.w > near) b = mix(b, a, (near - b.w) / (a.w - b.w));
  vec2 p = a.xy / a.w * size, q = b.xy / b.w * size, d = q - p;
  vec2 along = length(d) > 1e-4 ? normalize(d) : vec2(1, 0), across = vec2(-along.y, along.x);
  vec4 end = (gl_VertexID & 1) == 0 ? a : b;
  float side = (gl_VertexID & 2) == 0 ? -1.0 : 1.0, beyond = (gl_VertexID & 1) == 0 ? -0.5 : 0.5;
  end.xy += (across * side + along * beyond) * width / size * end.w;
  colour = tint;
  gl_Position = a.w < near && b.w < near ? vec4(0, 0, 2, 1) : end;
}`;
const lineFragment = `#version 300 es
precision highp float; in vec4 colour; out vec4 result;
void main() { result = vec4(colour.rgb, 1.0) * colour.a; }`;

const byte = (v: number) => Math.round(255 * Math.min(1, Math.max(0, v)));
const packed = (c: Rgba) => (byte(c[0]) | (byte(c[1]) << 8) | (byte(c[2]) << 16) | (byte(c[3]) << 24)) >>> 0;

/** Numbers that grow, with colours of 32 bits among them. */
class Words {
  values = new Float32Array(1 << 14);
  colours = new Uint32Array(this.values.buffer);
  count = 0;
  put(...words: number[]) {
    this.room(words.length);
    for (const word of words) this.values[this.count++] = word;
  }
  putColour(colour: number) {
    this.room(1);
    this.colours[this.count++] = colour;
  }
  private room(more: number) {
    if (this.count + more <= this.values.length) return;
    const larger = new Float32Array(2 * (this.count + more));
    larger.set(this.values);
    this.values = larger;
    this.colours = new Uint32Array(larger.buffer);
  }
}

/** Triangles with a normal and a colour at each corner; positions in m, map frame, relative to `origin`. */
export class Solids {
  readonly words = new Words();
  constructor(readonly origin: Vector = [0, 0, 0]) {}
  static readonly stride = 7; // words of a corner

  quad(a: Vector, b: Vector, c: Vector, d: Vector, colour: Rgba) {
    const u = b.map((v, i) => v - a[i]), w = d.map((v, i) => v - a[i]);
    const n = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]], length = Math.hypot(...n) || 1;
    const tint = packed(colour), o = this.origin;
    for (const p of [a, b, c, a, c, d]) {
      this.words.put(p[0] - o[0], p[1] - o[1], p[2] - o[2], n[0] / length, n[1] / length, n[2] / length);
      this.words.putColour(tint);
    }
  }

  /** A body with vertical sides over a convex outline, which runs against the clock, from one height to another (m). */
  prism(outline: [number, number][], bottom: number, top: number, colour: Rgba, roof: Rgba = colour) {
    const n = outline.length;
    outline.forEach(([x, y], i) => {
      const [nx, ny] = outline[(i + 1) % n];
      this.quad([x, y, bottom], [nx, ny, bottom], [nx, ny, top], [x, y, top], colour);
      if (i > 0 && i + 1 < n) this.quad([...outline[0], top], [x, y, top], [nx, ny, top], [nx, ny, top], roof);
    });
  }
}

/** Lines of a width in pixels. */
export class Lines {
  readonly words = new Words();
  count = 0;
  constructor(readonly origin: Vector) {}
  static readonly stride = 8; // words of a corner; a line has four

  segment(from: Vector, to: Vector, colour: Rgba, width: number) {
    const o = this.origin, tint = packed(colour);
    for (let corner = 0; corner < 4; ++corner) {
      this.words.put(from[0] - o[0], from[1] - o[1], from[2] - o[2], to[0] - o[0], to[1] - o[1], to[2] - o[2]);
      this.words.putColour(tint);
      this.words.put(width);
    }
    ++this.count;
  }
  polyline(xy: ArrayLike<number>, from: number, count: number, z: number, colour: Rgba, width: number) {
    for (let i = from; i < from + count - 1; ++i) this.segment([xy[2 * i], xy[2 * i + 1], z], [xy[2 * i + 2], xy[2 * i + 3], z], colour, width);
  }
}

/** Draws solids and lines in space, with the context of the view from above. */
export class Renderer {
  private readonly solid: WebGLProgram;
  private readonly floor: WebGLProgram;
  private readonly line: WebGLProgram;
  private readonly quad: { array: WebGLVertexArrayObject };
  private readonly lineArray: { array: WebGLVertexArrayObject; buffer: WebGLBuffer };
  private readonly indices: WebGLBuffer;
  private indexed = 0;
  private orbit!: Orbit;
  private sky: Rgba = [0, 0, 0, 1];

  constructor(private readonly gl: WebGL2RenderingContext, compile: (vertex: string, fragment: string) => WebGLProgram) {
    this.solid = compile(solidVertex, solidFragment);
    this.floor = compile(floorVertex, floorFragment);
    this.line = compile(lineVertex, lineFragment);
    this.quad = this.array([[2, gl.FLOAT]], 2);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([0, 0, 1, 0, 0, 1, 1, 1]), gl.STATIC_DRAW);
    this.lineArray = this.array([[3, gl.FLOAT], [3, gl.FLOAT], [4, gl.UNSIGNED_BYTE], [1, gl.FLOAT]], Lines.stride);
    this.indices = gl.createBuffer()!;
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.indices);
  }

  private array(parts: [number, number][], stride: number) {
    const gl = this.gl, array = gl.createVertexArray()!, buffer = gl.createBuffer()!;
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    let at = 0;
    parts.forEach(([size, type], location) => {
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, size, type, type === gl.UNSIGNED_BYTE, 4 * stride, at);
      at += type === gl.UNSIGNED_BYTE ? 4 : 4 * size;
    });
    return { array, buffer };
  }

  /** Begins a picture on the cleared canvas; colours fade into `sky` with distance. */
  begin(orbit: Orbit, sky: Rgba) {
    const gl = this.gl;
    this.orbit = orbit;
    this.sky = sky;
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
  }
  end() {
    this.gl.disable(this.gl.DEPTH_TEST);
    this.gl.depthMask(true);
  }

  private use(program: WebGLProgram, origin: Vector) {
    const gl = this.gl, at = (name: string) => gl.getUniformLocation(program, name), t = this.orbit.target;
    gl.useProgram(program);
    gl.uniformMatrix4fv(at("view"), false, this.orbit.matrix());
    gl.uniform3f(at("origin"), t[0] - origin[0], t[1] - origin[1], t[2] - origin[2]);
    gl.uniform3f(at("sky"), this.sky[0], this.sky[1], this.sky[2]);
    gl.uniform1f(at("haze"), 0.35 / Math.max(12, this.orbit.distance * 3));
    return at;
  }

  /** The ground: cells with the corner of the first at (x, y, yaw), `width` x `height` m. */
  ground(texture: WebGLTexture, x: number, y: number, yaw: number, width: number, height: number, inside: Rgba, outside: Rgba) {
    const gl = this.gl, at = this.use(this.floor, [0, 0, 0]);
    gl.uniform4f(at("place"), x, y, Math.cos(yaw), Math.sin(yaw));
    gl.uniform2f(at("extent"), width, height);
    gl.uniform4fv(at("inside"), inside);
    gl.uniform4fv(at("outside"), outside);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.bindVertexArray(this.quad.array);
    gl.depthMask(false);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.depthMask(true);
  }

  /** Puts solids on the device, for pictures without end. */
  mesh(solids: Solids, before?: Mesh): Mesh {
    const gl = this.gl, made = before ?? { ...this.array([[3, gl.FLOAT], [3, gl.FLOAT], [4, gl.UNSIGNED_BYTE]], Solids.stride), corners: 0, origin: solids.origin };
    gl.bindBuffer(gl.ARRAY_BUFFER, made.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, solids.words.values.subarray(0, solids.words.count), gl.DYNAMIC_DRAW);
    return Object.assign(made, { corners: solids.words.count / Solids.stride, origin: solids.origin });
  }
  draw(mesh: Mesh) {
    this.use(this.solid, mesh.origin);
    this.gl.bindVertexArray(mesh.array);
    this.gl.drawArrays(this.gl.TRIANGLES, 0, mesh.corners);
  }

  /** Lines hide nothing. */
  lines(lines: Lines) {
    if (!lines.count) return;
    const gl = this.gl, at = this.use(this.line, lines.origin);
    gl.uniform2f(at("size"), this.orbit.width, this.orbit.height);
    gl.bindVertexArray(this.lineArray.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.lineArray.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, lines.words.values.subarray(0, lines.words.count), gl.STREAM_DRAW);
    this.index(lines.count);
    gl.depthMask(false);
    gl.drawElements(gl.TRIANGLES, 6 * lines.count, gl.UNSIGNED_INT, 0);
    gl.depthMask(true);
  }
  private index(lines: number) {
    if (lines <= this.indexed) return;
    this.indexed = 2 * lines;
    const corners = [0, 1, 2, 2, 1, 3], all = Uint32Array.from({ length: 6 * this.indexed }, (_, i) => 4 * Math.floor(i / 6) + corners[i % 6]);
    this.gl.bufferData(this.gl.ELEMENT_ARRAY_BUFFER, all, this.gl.STATIC_DRAW);
  }
}

export interface Mesh { array: WebGLVertexArrayObject; buffer: WebGLBuffer; corners: number; origin: Vector }
