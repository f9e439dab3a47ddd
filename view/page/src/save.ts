import { get } from "./dom";
import { page, send } from "./page";
import { Popover } from "./popover";
import { copy, download, toast } from "./toast";

/** Saves a file that the server has made. */
export function saveFile(name: string, content: Uint8Array) {
  const type = name.endsWith(".html") ? "text/html" : "application/octet-stream";
  download(name, content as BlobPart, type);
  toast(`Saved ${name}, ${(content.length / 1e6).toFixed(1)} MB.`);
}

/** The menu that saves a picture, the last minute as a replay or a recording, or a link. Returns the menu. */
export function attachSaveMenu(drawScene: () => void): Popover {
  const menu = new Popover(get("save-open"), get("save"));
  const on = (id: string, act: () => void) =>
    (get(id).onclick = () => {
      menu.close();
      act();
    });
  on("save-picture", () => {
    drawScene();
    const name = `slalom-${page.state?.course}-${page.state?.tick}.png`;
    get<HTMLCanvasElement>("scene").toBlob((blob) => blob && download(name, blob, "image/png"));
  });
  on("save-replay", () => {
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
