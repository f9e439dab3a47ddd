import { get } from "./dom";
import { page, send } from "./page";
import { picture } from "./scene/picture";
import { Popover } from "./popover";
import type { SceneView } from "./scene/scene";
import { copy, download, toast } from "./toast";

/** Saves a file that the server has made. */
export function saveFile(name: string, content: Uint8Array) {
  const type = name.endsWith(".html") ? "text/html" : "application/octet-stream";
  download(name, content as BlobPart, type);
  toast(`Saved ${name}, ${(content.length / 1e6).toFixed(1)} MB.`);
}

/** The menu that saves a picture, the last minute as a replay or a recording, or a link. Returns the menu. */
export function attachSaveMenu(scene: SceneView): Popover {
  const menu = new Popover(get("save-open"), get("save"));
  const on = (id: string, act: () => void) =>
    (get(id).onclick = () => {
      menu.close();
      act();
    });
  for (const format of ["png", "svg"] as const)
    on("save-" + format, () => {
      const name = `slalom-${page.state?.course}-${page.state?.tick}.${format}`;
      void picture(scene, format).then((blob) => download(name, blob, blob.type));
    });
  for (const what of ["replay", "recording"])
    on("save-" + what, () => {
      toast(`Saving a ${what} of the last minute …`);
      send({ do: "save", what });
    });
  on("save-link", () => copy(location.href, "a link"));
  return menu;
}
