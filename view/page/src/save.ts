import { get } from "./dom";
import { Popover } from "./popover";
import type { State } from "./protocol";
import { download, picture } from "./scene/picture";
import { copy, toast } from "./toast";

/** Saves the replay that this page is, by fetching it again; a page opened from disk may not do that. */
async function saveThisPage() {
  try {
    const text = await (await fetch(location.href)).text();
    download("slalom-replay.html", text, "text/html");
  } catch {
    toast("This page is the replay; it is already on your disk.");
  }
}

/** Saves a file that the server has made. */
export function saveFile(name: string, content: Uint8Array) {
  const type = name.endsWith(".html") ? "text/html" : "application/octet-stream";
  download(name, content as BlobPart, type);
  toast(`Saved ${name}, ${(content.length / 1e6).toFixed(1)} MB.`);
}

/** The menu that saves a picture, the last minute as a replay or a recording, or a link. Returns the menu. */
export function attachSaveMenu(
  send: (command: Record<string, unknown>) => void,
  drawScene: () => void,
  state: () => State | undefined,
  isReplay: boolean,
): Popover {
  const menu = new Popover(get("save-open"), get("save"));
  const on = (id: string, act: () => void) =>
    (get(id).onclick = () => {
      menu.close();
      act();
    });
  on("save-picture", () => {
    drawScene();
    const name = `slalom-${state()?.course}-${state()?.tick}.png`;
    void picture(get<HTMLCanvasElement>("scene"), get("stage")).then((blob) =>
      download(name, blob, "image/png"),
    );
  });
  on("save-replay", () => {
    if (isReplay) return void saveThisPage();
    toast("Saving a replay of the last minute …");
    send({ do: "save", what: "replay" });
  });
  on("save-recording", () => {
    toast("Saving a recording of the last minute …");
    send({ do: "save", what: "recording" });
  });
  on("save-link", () => copy(location.href, "a link"));
  return menu;
}
