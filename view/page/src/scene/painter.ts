import { make } from "../dom";
import type { Pose } from "../protocol";
import type { Camera } from "./camera";
import { css, type Rgba } from "./palette";

export type Pen = CanvasRenderingContext2D;

/** Draws lines and shapes in the order of the calls. Positions are in m (map frame), widths in pixels. */
export class Painter {
  private pixel = 1; // size of a CSS pixel, m

  /** `ratio`: pixels of the pen for each CSS pixel. */
  constructor(
    private readonly pen: Pen,
    private readonly ratio: number,
  ) {}

  /** Begins a picture of this size (CSS pixels). */
  begin(width: number, height: number, ground: Rgba) {
    this.pen.save();
    this.pen.fillStyle = css(ground);
    this.pen.fillRect(0, 0, width * this.ratio, height * this.ratio);
    this.pen.save();
  }

  /** Ends the picture: the pen is as it was. */
  end() {
    this.pen.restore();
    this.pen.restore();
  }

  /** Limits the following drawings to the part of the picture that a camera covers. */
  look(c: Camera) {
    const { pen, ratio } = this;
    pen.restore();
    pen.save();
    pen.beginPath();
    pen.rect(c.left * ratio, c.top * ratio, c.width * ratio, c.height * ratio);
    pen.clip();
    pen.setTransform(ratio, 0, 0, ratio, c.middleX * ratio, c.middleY * ratio);
    pen.scale(c.zoom, -c.zoom);
    pen.rotate(c.turn);
    pen.translate(-c.x, -c.y);
    pen.lineJoin = "round";
    this.pixel = 1 / c.zoom;
  }

  private stroke(colour: Rgba, width: number) {
    this.pen.strokeStyle = css(colour);
    this.pen.lineWidth = width * this.pixel;
    this.pen.stroke();
  }

  private trace(points: [number, number][]) {
    this.pen.beginPath();
    for (const [x, y] of points) this.pen.lineTo(x, y);
    this.pen.closePath();
  }

  segment(x0: number, y0: number, x1: number, y1: number, colour: Rgba, width: number) {
    this.polyline([x0, y0, x1, y1], 0, 2, colour, width);
  }

  /** Draws a line through `count` of the points x, y, x, y ..., beginning with point `from`. */
  polyline(xy: ArrayLike<number>, from: number, count: number, colour: Rgba, width: number) {
    this.pen.beginPath();
    for (let i = from; i < from + count; ++i) this.pen.lineTo(xy[2 * i], xy[2 * i + 1]);
    this.stroke(colour, width);
  }

  /** Draws every second segment of a line. */
  dashed(xy: ArrayLike<number>, count: number, colour: Rgba, width: number) {
    this.pen.beginPath();
    for (let i = 0; i < count; ++i) this.pen[i % 2 ? "lineTo" : "moveTo"](xy[2 * i], xy[2 * i + 1]);
    this.stroke(colour, width);
  }

  fill(points: [number, number][], colour: Rgba) {
    this.trace(points);
    this.pen.fillStyle = css(colour);
    this.pen.fill();
  }

  outline(points: [number, number][], colour: Rgba, width: number) {
    this.trace(points);
    this.stroke(colour, width);
  }

  dot(x: number, y: number, diameter: number, colour: Rgba) {
    this.pen.beginPath();
    this.pen.arc(x, y, (diameter / 2) * this.pixel, 0, 2 * Math.PI);
    this.pen.fillStyle = css(colour);
    this.pen.fill();
  }

  /** Draws squares, for points so many and small that nobody sees their form. */
  dots(points: Iterable<[number, number]>, size: number, colour: Rgba) {
    const side = size * this.pixel;
    this.pen.fillStyle = css(colour);
    for (const [x, y] of points) this.pen.fillRect(x - side / 2, y - side / 2, side, side);
  }

  /** Draws an image with the corner of its first pixel at a pose; its rows follow one another to the left. */
  image(image: HTMLCanvasElement, at: Pose, width: number, height: number) {
    const { pen } = this;
    pen.save();
    pen.translate(at.x, at.y);
    pen.rotate(at.yaw);
    // Only an image that is made much smaller needs more than its four nearest pixels, which is slow.
    pen.imageSmoothingQuality = image.width * this.pixel > 2 * width * this.ratio ? "medium" : "low";
    pen.drawImage(image, 0, 0, width, height);
    pen.restore();
  }
}

/** A painter of a whole canvas of the page, sharp on its screen. */
export function painterOf(canvas: HTMLCanvasElement, size: { width: number; height: number }): Painter {
  const ratio = Math.min(2, window.devicePixelRatio || 1);
  const pen = canvas.getContext("2d", { alpha: false })!;
  const [width, height] = [size.width, size.height].map((side) => Math.max(1, Math.round(side * ratio)));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  pen.reset();
  return new Painter(pen, ratio);
}

/** An image of pixels, each a colour of `packed`. */
export function imageOf(width: number, height: number, colourOf: (x: number, y: number) => number) {
  const image = make("canvas", { width, height });
  const data = new ImageData(width, height);
  const pixels = new Uint32Array(data.data.buffer);
  for (let y = 0; y < height; ++y) for (let x = 0; x < width; ++x) pixels[y * width + x] = colourOf(x, y);
  image.getContext("2d")!.putImageData(data, 0, 0);
  return image;
}
/** A colour as a pixel of an image. */
export const packed = (colour: Rgba) => new Uint32Array(Uint8Array.from(colour, (v) => 255 * v).buffer)[0];
