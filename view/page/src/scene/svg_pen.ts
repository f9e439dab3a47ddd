import type { Pen } from "./painter";

const escaped = (text: string) => text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
const rounded = (value: number) => String(Math.round(100 * value) / 100);

/** Draws as a canvas does, into an SVG document of a size in pixels. */
export class SvgPen implements Pen {
  fillStyle: Pen["fillStyle"] = "#000";
  strokeStyle: Pen["strokeStyle"] = "#000";
  lineWidth = 1;
  lineJoin: CanvasLineJoin = "miter";
  imageSmoothingQuality: ImageSmoothingQuality = "low"; // the viewer's choice
  font = "13px sans-serif";
  private matrix = new DOMMatrix();
  private path = "";
  private readonly parts: string[] = [];
  private readonly saved: { matrix: DOMMatrix; clips: number }[] = [];
  private clips = 0; // groups that are open

  constructor(
    private readonly width: number,
    private readonly height: number,
  ) {}

  save() {
    this.saved.push({ matrix: DOMMatrix.fromMatrix(this.matrix), clips: this.clips });
  }
  restore() {
    const { matrix, clips } = this.saved.pop()!;
    while (this.clips > clips) this.closeClip();
    this.matrix = matrix;
  }
  setTransform(...[a, b, c, d, e, f]: number[]) {
    this.matrix = new DOMMatrix([a, b, c, d, e, f]);
  }
  scale(x: number, y: number) {
    this.matrix.scaleSelf(x, y);
  }
  rotate(angle: number) {
    this.matrix.rotateSelf((angle * 180) / Math.PI);
  }
  translate(x: number, y: number) {
    this.matrix.translateSelf(x, y);
  }

  beginPath() {
    this.path = "";
  }
  closePath() {
    if (this.path) this.path += "Z";
  }
  moveTo(x: number, y: number) {
    this.path += "M" + this.place(x, y);
  }
  lineTo(x: number, y: number) {
    this.path += (this.path ? "L" : "M") + this.place(x, y);
  }
  /** A whole circle. */
  arc(x: number, y: number, radius: number) {
    const r = rounded(radius * this.zoom);
    const [from, to] = [x - radius, x + radius].map((at) => this.place(at, y));
    this.path += `M${from}A${r} ${r} 0 1 1 ${to}A${r} ${r} 0 1 1 ${from}Z`;
  }
  rect(x: number, y: number, width: number, height: number) {
    const corners = [this.place(x + width, y), this.place(x + width, y + height), this.place(x, y + height)];
    this.path += `M${this.place(x, y)}L${corners.join("L")}Z`;
  }

  clip() {
    const id = `clip${this.parts.length}`;
    this.parts.push(`<clipPath id="${id}"><path d="${this.path}"/></clipPath><g clip-path="url(#${id})">`);
    this.clips += 1;
  }
  fill() {
    this.add("path", `d="${this.path}" ${this.colour("fill", this.fillStyle)}`);
  }
  stroke() {
    const line = `stroke-width="${rounded(this.lineWidth * this.zoom)}" stroke-linejoin="${this.lineJoin}"`;
    this.add("path", `d="${this.path}" fill="none" ${this.colour("stroke", this.strokeStyle)} ${line}`);
  }
  fillRect(x: number, y: number, width: number, height: number) {
    this.beginPath();
    this.rect(x, y, width, height);
    this.fill();
  }
  fillText(text: string, x: number, y: number) {
    const [px, py] = this.place(x, y).split(" ");
    const look = `${this.colour("fill", this.fillStyle)} style="font:${escaped(this.font)}"`;
    this.parts.push(`<text x="${px}" y="${py}" ${look}>${escaped(text)}</text>`);
  }
  drawImage(image: CanvasImageSource, x: number, y: number, width: number, height: number) {
    const { a, b, c, d, e, f } = this.matrix;
    const place = `x="${x}" y="${y}" width="${width}" height="${height}" preserveAspectRatio="none"`;
    const data = (image as HTMLCanvasElement).toDataURL();
    this.add("image", `${place} transform="matrix(${[a, b, c, d, e, f].join(" ")})" href="${data}"`);
  }

  /** The document. */
  text() {
    while (this.clips > 0) this.closeClip();
    const size = `width="${this.width}" height="${this.height}" viewBox="0 0 ${this.width} ${this.height}"`;
    return `<svg xmlns="http://www.w3.org/2000/svg" ${size}>\n${this.parts.join("\n")}\n</svg>\n`;
  }

  private add(element: string, attributes: string) {
    this.parts.push(`<${element} ${attributes}/>`);
  }
  private closeClip() {
    this.parts.push("</g>");
    this.clips -= 1;
  }
  /** Pixels for each unit of the present coordinates. */
  private get zoom() {
    return Math.hypot(this.matrix.a, this.matrix.b);
  }
  private place(x: number, y: number) {
    const { a, b, c, d, e, f } = this.matrix;
    return `${rounded(a * x + c * y + e)} ${rounded(b * x + d * y + f)}`;
  }
  /** A colour as attributes that every program reads. */
  private colour(name: "fill" | "stroke", style: Pen["fillStyle"]) {
    const [, rgb, opacity] = /^rgb\((.*) \/ (.*)\)$/.exec(String(style)) ?? [];
    if (!rgb) return `${name}="${String(style)}"`;
    return (
      `${name}="rgb(${rgb.replaceAll(" ", ",")})"` + (opacity === "1" ? "" : ` ${name}-opacity="${opacity}"`)
    );
  }
}
