/** Offers bytes to the user as a file. */
export function download(name: string, content: BlobPart, type: string) {
  const link = document.createElement("a");
  link.download = name;
  link.href = URL.createObjectURL(new Blob([content], { type }));
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** The scene as a picture, with the labels and figures that stand over it. */
export function picture(scene: HTMLCanvasElement, stage: HTMLElement): Promise<Blob> {
  const ratio = scene.width / scene.clientWidth;
  const canvas = document.createElement("canvas");
  const to = canvas.getContext("2d")!;
  canvas.width = scene.width;
  canvas.height = scene.height;
  to.drawImage(scene, 0, 0);
  to.scale(ratio, ratio);
  const origin = stage.getBoundingClientRect();
  for (const element of stage.querySelectorAll<HTMLElement>(".tag, #readout, #ruler")) {
    const box = element.getBoundingClientRect();
    const style = getComputedStyle(element);
    if (!box.width) continue;
    if (style.backgroundColor !== "rgba(0, 0, 0, 0)") {
      to.fillStyle = style.backgroundColor;
      to.beginPath();
      to.roundRect(box.x - origin.x, box.y - origin.y, box.width, box.height, Math.min(10, box.height / 2));
      to.fill();
    }
    drawText(to, element, origin);
  }
  const bar = stage.querySelector("#ruler-bar")?.getBoundingClientRect();
  if (bar?.width) {
    to.strokeStyle = getComputedStyle(stage).color;
    to.strokeRect(bar.x - origin.x, bar.bottom - origin.y, bar.width, 0);
  }
  return new Promise((done, fail) =>
    canvas.toBlob((blob) => (blob ? done(blob) : fail(new Error("no picture"))), "image/png"),
  );
}

function drawText(to: CanvasRenderingContext2D, element: HTMLElement, origin: DOMRect) {
  const words = document.createTreeWalker(element, NodeFilter.SHOW_TEXT);
  const range = document.createRange();
  for (let node = words.nextNode(); node; node = words.nextNode()) {
    const text = node.textContent!.trim();
    range.selectNodeContents(node);
    const box = range.getBoundingClientRect();
    if (!text || !box.width) continue;
    const style = getComputedStyle(node.parentElement!);
    to.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
    to.fillStyle = style.color;
    to.textBaseline = "middle";
    to.fillText(text, box.x - origin.x, box.y - origin.y + box.height / 2);
  }
}
