const gravity = 9.81; // m/s^2
const most = 60; // m/s^2; more is not driving: the car was put elsewhere, or hit something
const size = 210; // px

/** The colours of the page by the names of their variables. */
type Colours = (name: string) => string;

/** The mean acceleration between two control steps, m/s^2: along the direction of travel, and to its left. */
function between(a: Float64Array, b: Float64Array, duration: number, index: (name: string) => number): [number, number] {
  const speed = index("speed"), yaw = index("yaw"), slip = index("slip"), turn = b[yaw] + b[slip] - a[yaw] - a[slip];
  const half = 0.5 * Math.atan2(Math.sin(turn), Math.cos(turn));
  return [((b[speed] - a[speed]) * Math.cos(half)) / duration, ((b[speed] + a[speed]) * Math.sin(half)) / duration];
}

/** The diagram of accelerations: forwards up, to the left on the left, with the circle that the friction allows. */
export class Accelerations {
  private readonly canvas = document.createElement("canvas");

  constructor(holder: HTMLElement, private readonly value: HTMLElement) {
    this.canvas.className = "accelerations";
    this.canvas.setAttribute("role", "img");
    holder.append(this.canvas);
  }

  /** The steps of the window that the charts show, `period` s apart, and the one that is shown in the scene. */
  draw(steps: (Float64Array | undefined)[], shown: number, period: number, scalars: string[], colours: Colours) {
    const index = (name: string) => scalars.indexOf(name), points: { along: number; left: number; isShown: boolean }[] = [];
    for (let i = 1; i < steps.length; ++i) {
      const a = steps[i - 1], b = steps[i];
      if (!a || !b) continue;
      const [along, left] = between(a, b, period, index);
      if (Math.hypot(along, left) < most) points.push({ along, left, isShown: i === shown });
    }
    const friction = steps[shown]?.[index("friction_estimate")] ?? NaN, circle = gravity * friction;
    const reach = 1.08 * Math.max(5, Number.isFinite(circle) ? circle : 0, ...points.map((p) => Math.max(Math.abs(p.along), Math.abs(p.left))));
    const now = points.find((p) => p.isShown);
    const words = now ? `${Math.hypot(now.along, now.left).toFixed(1)}${Number.isFinite(circle) ? ` of ${circle.toFixed(1)}` : ""}` : "–";
    this.value.textContent = words;
    this.canvas.setAttribute("aria-label", `Accelerations of the car along and across, m/s²; at the step shown ${words}`);
    this.paint(points, circle, reach, colours);
  }

  private paint(points: { along: number; left: number; isShown: boolean }[], circle: number, reach: number, colours: Colours) {
    const { canvas } = this, scale = devicePixelRatio;
    canvas.width = canvas.height = Math.round(size * scale);
    const pen = canvas.getContext("2d")!, middle = canvas.width / 2, unit = middle / reach;
    const ring = (radius: number, colour: string, width: number) => {
      pen.strokeStyle = colour;
      pen.lineWidth = width * scale;
      pen.beginPath();
      pen.arc(middle, middle, radius * unit, 0, 2 * Math.PI);
      pen.stroke();
    };
    pen.strokeStyle = colours("--line");
    pen.lineWidth = scale;
    pen.beginPath();
    for (const [x0, y0, x1, y1] of [[0, middle, canvas.width, middle], [middle, 0, middle, canvas.width]]) { pen.moveTo(x0, y0); pen.lineTo(x1, y1); }
    pen.stroke();
    pen.fillStyle = colours("--soft");
    pen.font = `${10 * scale}px system-ui, sans-serif`;
    for (let radius = 5; radius < reach; radius += 5) {
      ring(radius, colours("--line"), 1);
      pen.fillText(String(radius), middle + 3 * scale, middle - radius * unit - 2 * scale);
    }
    if (Number.isFinite(circle)) ring(circle, colours("--warn"), 1.6);
    for (const { along, left, isShown } of points) {
      pen.globalAlpha = isShown ? 1 : 0.4;
      pen.fillStyle = colours(isShown ? "--text" : "--accent");
      pen.beginPath();
      pen.arc(middle - left * unit, middle - along * unit, (isShown ? 4 : 1.7) * scale, 0, 2 * Math.PI);
      pen.fill();
    }
    pen.globalAlpha = 1;
  }
}
