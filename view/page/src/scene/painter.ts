import type { Camera } from "./camera";
import type { Rgba } from "./palette";

const lineVertex = `#version 300 es
layout(location=0) in vec4 ends; layout(location=1) in vec4 tint;
layout(location=2) in float width; // below 0: no round ends
uniform vec4 view; uniform vec2 size; uniform vec2 turn;
out vec4 colour; out vec2 local; flat out float len; flat out float halfWidth; flat out float roundEnds;
vec2 pixel(vec2 p) {
  vec2 d = p * view.z;
  return vec2(turn.x * d.x - turn.y * d.y, turn.y * d.x + turn.x * d.y);
}
void main() {
  vec2 corner = vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1);
  vec2 a = pixel(ends.xy), b = pixel(ends.zw), d = b - a;
  len = length(d);
  vec2 along = len > 1e-6 ? d / len : vec2(1, 0), across = vec2(-along.y, along.x);
  halfWidth = 0.5 * abs(width) * view.w; roundEnds = width > 0.0 ? 1.0 : 0.0;
  float reach = halfWidth + 1.0, extend = roundEnds > 0.5 ? reach : 0.0;
  local = vec2(mix(-extend, len + extend, corner.x), mix(-reach, reach, corner.y));
  vec2 p = a + along * local.x + across * local.y;
  colour = tint;
  gl_Position = vec4(2.0 * p / size + view.xy, 0, 1);
}`;
const lineFragment = `#version 300 es
precision highp float;
in vec4 colour; in vec2 local; out vec4 result;
flat in float len; flat in float halfWidth; flat in float roundEnds;
void main() {
  float beyond = roundEnds > 0.5 ? max(max(-local.x, local.x - len), 0.0) : 0.0;
  float cover = clamp(halfWidth + 0.5 - length(vec2(beyond, local.y)), 0.0, 1.0) * min(1.0, 2.0 * halfWidth);
  result = vec4(colour.rgb, 1.0) * (colour.a * cover);
}`;
const fillVertex = `#version 300 es
layout(location=0) in vec2 point; layout(location=1) in vec4 tint;
uniform vec4 view; uniform vec2 size; uniform vec2 turn; out vec4 colour;
void main() {
  vec2 d = point * view.z; vec2 p = vec2(turn.x * d.x - turn.y * d.y, turn.y * d.x + turn.x * d.y);
  colour = tint; gl_Position = vec4(2.0 * p / size + view.xy, 0, 1);
}`;
const fillFragment = `#version 300 es
precision highp float; in vec4 colour; out vec4 result;
void main() { result = vec4(colour.rgb, 1.0) * colour.a; }`;
const cellVertex = `#version 300 es
layout(location=0) in vec2 corner;
uniform vec4 view; uniform vec2 size; uniform vec2 turn; uniform vec4 place; uniform vec2 extent; out vec2 uv;
void main() {
  uv = corner;
  vec2 q = corner * extent;
  vec2 m = place.xy + vec2(place.z * q.x - place.w * q.y, place.w * q.x + place.z * q.y);
  vec2 d = m * view.z; vec2 p = vec2(turn.x * d.x - turn.y * d.y, turn.y * d.x + turn.x * d.y);
  gl_Position = vec4(2.0 * p / size + view.xy, 0, 1);
}`;
const cellFragment = `#version 300 es
precision highp float; in vec2 uv; out vec4 result;
uniform sampler2D cells; uniform vec4 inside, outside, edge; uniform float edgeWidth;
void main() {
  float v = texture(cells, uv).r, w = max(fwidth(v), 1e-4);
  float wall = smoothstep(0.5 - w, 0.5 + w, v);
  vec4 c = mix(outside, inside, wall);
  float rim = 1.0 - smoothstep(edgeWidth, edgeWidth + 1.0, abs(v - 0.5) / w);
  c = mix(c, edge, rim * edge.a);
  result = vec4(c.rgb, 1.0) * c.a;
}`;

const byte = (v: number) => Math.round(255 * Math.min(1, Math.max(0, v)));
const bytes = (c: Rgba) => (byte(c[0]) | (byte(c[1]) << 8) | (byte(c[2]) << 16) | (byte(c[3]) << 24)) >>> 0;

/** Takes the place of a context that the browser does not have. */
const nothing = new Proxy({}, { get: () => () => 1 }) as unknown as WebGL2RenderingContext;

interface Program {
  program: WebGLProgram;
  view: WebGLUniformLocation | null;
  size: WebGLUniformLocation | null;
  turn: WebGLUniformLocation | null;
}

const vertexWords = 6; // words of a line: ends, colour, width
const lineWords = 4 * vertexWords;

/**
 * Collects lines and triangles in layers and draws them in order; positions in m of the map frame. Each line
 * has four vertices of its own: without a graphics card, instanced drawing takes a hundred times as long.
 */
export class Painter {
  private readonly gl: WebGL2RenderingContext;
  /** Whether there is WebGL 2. Without it nothing is drawn, and the rest of the page works. */
  readonly canDraw: boolean;
  private readonly line: Program;
  private readonly fill: Program;
  private readonly cell: Program;
  private readonly lineArray: WebGLVertexArrayObject;
  private readonly fillArray: WebGLVertexArrayObject;
  private readonly cellArray: WebGLVertexArrayObject;
  private readonly lineBuffer: WebGLBuffer;
  private readonly fillBuffer: WebGLBuffer;
  private readonly indexBuffer: WebGLBuffer;
  private indexed = 0; // lines that the index buffer has room for
  private lines = new Float32Array(lineWords * 4096);
  private colours = new Uint32Array(this.lines.buffer);
  private lineCount = 0;
  private fills = new Float32Array(6 * 1024);
  private fillCount = 0;
  private camera!: Camera;
  private ratio = 1;

  constructor(private readonly canvas: HTMLCanvasElement) {
    const gl =
      canvas.getContext("webgl2", { alpha: false, antialias: true, preserveDrawingBuffer: true }) ?? nothing;
    this.canDraw = gl !== nothing;
    this.gl = gl;
    this.line = this.compile(lineVertex, lineFragment);
    this.fill = this.compile(fillVertex, fillFragment);
    this.cell = this.compile(cellVertex, cellFragment);
    const quad = gl.createBuffer()!;
    gl.bindBuffer(gl.ARRAY_BUFFER, quad);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([0, 0, 1, 0, 0, 1, 1, 1]), gl.STATIC_DRAW);
    this.cellArray = gl.createVertexArray()!;
    gl.bindVertexArray(this.cellArray);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
    this.lineArray = gl.createVertexArray()!;
    gl.bindVertexArray(this.lineArray);
    this.indexBuffer = gl.createBuffer()!;
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.indexBuffer);
    this.lineBuffer = gl.createBuffer()!;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.lineBuffer);
    for (const location of [0, 1, 2]) gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(0, 4, gl.FLOAT, false, 4 * vertexWords, 0);
    gl.vertexAttribPointer(1, 4, gl.UNSIGNED_BYTE, true, 4 * vertexWords, 16);
    gl.vertexAttribPointer(2, 1, gl.FLOAT, false, 4 * vertexWords, 20);
    this.fillArray = gl.createVertexArray()!;
    gl.bindVertexArray(this.fillArray);
    this.fillBuffer = gl.createBuffer()!;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.fillBuffer);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 24, 0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 4, gl.FLOAT, false, 24, 8);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  private compile(vertex: string, fragment: string): Program {
    const gl = this.gl;
    const program = gl.createProgram()!;
    for (const [kind, source] of [
      [gl.VERTEX_SHADER, vertex],
      [gl.FRAGMENT_SHADER, fragment],
    ] as const) {
      const shader = gl.createShader(kind)!;
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
        throw new Error(gl.getShaderInfoLog(shader) ?? "shader");
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
      throw new Error(gl.getProgramInfoLog(program) ?? "program");
    const at = (name: string) => gl.getUniformLocation(program, name);
    return { program, view: at("view"), size: at("size"), turn: at("turn") };
  }

  /** Begins a picture of the size of the canvas. */
  begin(ground: Rgba) {
    const gl = this.gl;
    this.ratio = Math.min(2, window.devicePixelRatio || 1);
    const width = Math.max(1, Math.round(this.canvas.clientWidth * this.ratio));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * this.ratio));
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(ground[0], ground[1], ground[2], 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
    this.lineCount = this.fillCount = 0;
  }

  /** Limits the following drawings to the part of the canvas that a camera covers. */
  look(camera: Camera) {
    const r = this.ratio;
    const at = [
      camera.left * r,
      this.canvas.height - (camera.top + camera.height) * r,
      camera.width * r,
      camera.height * r,
    ].map(Math.round) as [number, number, number, number];
    this.camera = camera;
    this.gl.viewport(...at);
    this.gl.scissor(...at);
  }

  private use(p: Program) {
    const gl = this.gl;
    const c = this.camera;
    gl.useProgram(p.program);
    gl.uniform4f(
      p.view,
      (2 * (c.middleX - c.left)) / c.width - 1,
      1 - (2 * (c.middleY - c.top)) / c.height,
      c.zoom * this.ratio,
      this.ratio,
    );
    gl.uniform2f(p.size, c.width * this.ratio, c.height * this.ratio);
    gl.uniform2f(p.turn, Math.cos(c.turn), Math.sin(c.turn));
  }

  segment(x0: number, y0: number, x1: number, y1: number, colour: Rgba, width: number, round = true) {
    if (lineWords * (this.lineCount + 1) > this.lines.length) {
      const larger = new Float32Array(this.lines.length * 2);
      larger.set(this.lines);
      this.lines = larger;
      this.colours = new Uint32Array(larger.buffer);
    }
    const d = this.lines;
    const from = lineWords * this.lineCount++;
    const ox = this.camera.x;
    const oy = this.camera.y;
    const packed = bytes(colour);
    for (let i = from; i < from + lineWords; i += vertexWords) {
      d[i] = x0 - ox;
      d[i + 1] = y0 - oy;
      d[i + 2] = x1 - ox;
      d[i + 3] = y1 - oy;
      this.colours[i + 4] = packed;
      d[i + 5] = round ? width : -width;
    }
  }

  polyline(xy: ArrayLike<number>, from: number, count: number, colour: Rgba, width: number, round = true) {
    for (let i = from; i < from + count - 1; ++i)
      this.segment(xy[2 * i], xy[2 * i + 1], xy[2 * i + 2], xy[2 * i + 3], colour, width, round);
  }

  triangle(ax: number, ay: number, bx: number, by: number, cx: number, cy: number, colour: Rgba) {
    if (6 * (this.fillCount + 3) > this.fills.length) {
      const larger = new Float32Array(this.fills.length * 2);
      larger.set(this.fills);
      this.fills = larger;
    }
    const p = [ax, ay, bx, by, cx, cy];
    for (let k = 0; k < 3; ++k) {
      const i = 6 * this.fillCount++;
      this.fills[i] = p[2 * k] - this.camera.x;
      this.fills[i + 1] = p[2 * k + 1] - this.camera.y;
      this.fills.set(colour, i + 2);
    }
  }

  convex(points: [number, number][], colour: Rgba) {
    for (let i = 2; i < points.length; ++i)
      this.triangle(
        points[0][0],
        points[0][1],
        points[i - 1][0],
        points[i - 1][1],
        points[i][0],
        points[i][1],
        colour,
      );
  }

  outline(points: [number, number][], colour: Rgba, width: number) {
    points.forEach(([x, y], i) => {
      const [nx, ny] = points[(i + 1) % points.length];
      this.segment(x, y, nx, ny, colour, width);
    });
  }

  dot(x: number, y: number, diameter: number, colour: Rgba) {
    this.segment(x, y, x, y, colour, diameter);
  }

  /** Draws what was collected; triangles first. */
  flush() {
    const gl = this.gl;
    if (this.fillCount > 0) {
      this.use(this.fill);
      gl.bindVertexArray(this.fillArray);
      gl.bindBuffer(gl.ARRAY_BUFFER, this.fillBuffer);
      gl.bufferData(gl.ARRAY_BUFFER, this.fills.subarray(0, 6 * this.fillCount), gl.STREAM_DRAW);
      gl.drawArrays(gl.TRIANGLES, 0, this.fillCount);
    }
    if (this.lineCount > 0) {
      this.use(this.line);
      gl.bindVertexArray(this.lineArray);
      gl.bindBuffer(gl.ARRAY_BUFFER, this.lineBuffer);
      gl.bufferData(gl.ARRAY_BUFFER, this.lines.subarray(0, lineWords * this.lineCount), gl.STREAM_DRAW);
      this.index(this.lineCount);
      gl.drawElements(gl.TRIANGLES, 6 * this.lineCount, gl.UNSIGNED_INT, 0);
    }
    this.fillCount = this.lineCount = 0;
  }

  /** Two triangles for each of so many lines. */
  private index(lines: number) {
    if (lines <= this.indexed) return;
    this.indexed = 2 * lines;
    const corners = [0, 1, 2, 2, 1, 3];
    const all = new Uint32Array(6 * this.indexed);
    for (let i = 0; i < all.length; ++i) all[i] = 4 * Math.floor(i / 6) + corners[i % 6];
    this.gl.bufferData(this.gl.ELEMENT_ARRAY_BUFFER, all, this.gl.STATIC_DRAW);
  }

  texture(): WebGLTexture {
    const gl = this.gl;
    const texture = gl.createTexture()!;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    return texture;
  }

  upload(texture: WebGLTexture, width: number, height: number, cells: Uint8Array) {
    const gl = this.gl;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R8, width, height, 0, gl.RED, gl.UNSIGNED_BYTE, cells);
  }

  /** Draws cells with their first corner at a pose; the border runs where the value is a half. */
  cells(
    texture: WebGLTexture,
    place: { x: number; y: number; yaw: number; width: number; height: number },
    colours: { inside: Rgba; outside: Rgba; edge: Rgba },
    edgeWidth: number,
  ) {
    const gl = this.gl;
    const at = (name: string) => gl.getUniformLocation(this.cell.program, name);
    const { x, y, yaw } = place;
    this.use(this.cell);
    gl.uniform4f(at("place"), x - this.camera.x, y - this.camera.y, Math.cos(yaw), Math.sin(yaw));
    gl.uniform2f(at("extent"), place.width, place.height);
    for (const [name, colour] of Object.entries(colours)) gl.uniform4fv(at(name), colour);
    gl.uniform1f(at("edgeWidth"), edgeWidth * this.ratio);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.bindVertexArray(this.cellArray);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }
}
