import { get, make } from "./dom";

let timer = 0;

/** Shows a short message over the page; errors stay longer. */
export function toast(message: string, bad = false) {
  const box = get("toast");
  box.textContent = message;
  box.className = "card" + (bad ? " bad" : "");
  box.hidden = false;
  clearTimeout(timer);
  timer = window.setTimeout(() => (box.hidden = true), bad ? 6000 : 2500);
}

/** Copies a text; shows it where the clipboard is not available. */
export function copy(text: string, what: string) {
  const done = navigator.clipboard?.writeText(text);
  if (done)
    done.then(
      () => toast(`Copied as ${what}.`),
      () => toast(text),
    );
  else toast(text);
}

/** Offers bytes to the user as a file. */
export function download(name: string, content: BlobPart, type: string) {
  const link = make("a", { download: name, href: URL.createObjectURL(new Blob([content], { type })) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
