import { make } from "../dom";
import { css } from "./plots";

const gravity = 9.81; // m/s^2
const most = 60; // m/s^2; more is not driving: the car was put elsewhere, or hit something
const size = 210; // px

interface Point {
  along: number; // m/s^2, forwards
  left: number; // m/s^2
  isShown: boolean;
}

/** The diagram of accelerations: forwards is up; a circle shows what the friction allows. */
export class Accelerations {
  private readonly canvas = make("canvas", { className: "accelerations", role: "img" });

  constructor(
    holder: HTMLElement,
    private readonly value: HTMLElement,
  ) {
    holder.append(this.canvas);
  }

  /** Draws the steps that the charts show, `period` s apart, and the one that the scene shows. */
  draw(steps: (Float64Array | undefined)[], shown: number, period: number, scalars: string[]) {
    const [speed, yaw, slip] = ["speed", "yaw", "slip"].map((name) => scalars.indexOf(name));
    const points: Point[] = [];
    for (let i = 1; i < steps.length; ++i) {
      const [a, b] = [steps[i - 1], steps[i]];
      if (!a || !b) continue;
      // The mean acceleration between two steps, in the mean direction of travel.
      const turn = b[yaw] + b[slip] - a[yaw] - a[slip];
      const half = 0.5 * Math.atan2(Math.sin(turn), Math.cos(turn));
      const along = ((b[speed] - a[speed]) * Math.cos(half)) / period;
      const left = ((b[speed] + a[speed]) * Math.sin(half)) / period;
      if (Math.hypot(along, left) < most) points.push({ along, left, isShown: i === shown });
    }
    const circle = gravity * (steps[shown]?.[scalars.indexOf("friction_estimate")] ?? NaN);
    const now = points.find((p) => p.isShown);
    const of = Number.isFinite(circle) ? ` of ${circle.toFixed(1)}` : "";
    const words = now ? Math.hypot(now.along, now.left).toFixed(1) + of : "–";
    this.value.textContent = words;
    this.canvas.ariaLabel = `Accelerations of the car along and across, m/s²; at the step shown ${words}`;
    this.paint(points, circle);
  }

  private paint(points: Point[], circle: number) {
    const { canvas } = this;
    const scale = devicePixelRatio;
    canvas.width = canvas.height = Math.round(size * scale);
    const pen = canvas.getContext("2d")!;
    const middle = canvas.width / 2;
    const sizes = points.flatMap((p) => [Math.abs(p.along), Math.abs(p.left)]);
    const reach = 1.08 * Math.max(5, circle || 0, ...sizes);
    const unit = middle / reach;
    const ring = (radius: number, colour: string, width: number) => {
      pen.strokeStyle = css(colour);
      pen.lineWidth = width * scale;
      pen.beginPath();
      pen.arc(middle, middle, radius * unit, 0, 2 * Math.PI);
      pen.stroke();
    };
    pen.fillStyle = css("--line");
    pen.fillRect(0, middle, canvas.width, scale);
    pen.fillRect(middle, 0, scale, canvas.height);
    pen.fillStyle = css("--soft");
    pen.font = `${10 * scale}px system-ui, sans-serif`;
    for (let radius = 5; radius < reach; radius += 5) {
      ring(radius, "--line", 1);
      pen.fillText(String(radius), middle + 3 * scale, middle - radius * unit - 2 * scale);
    }
    if (Number.isFinite(circle)) ring(circle, "--warn", 1.6);
    for (const { along, left, isShown } of points) {
      pen.globalAlpha = isShown ? 1 : 0.4;
      pen.fillStyle = css(isShown ? "--text" : "--accent");
      pen.beginPath();
      pen.arc(middle - left * unit, middle - along * unit, (isShown ? 4 : 1.7) * scale, 0, 2 * Math.PI);
      pen.fill();
    }
  }
}
