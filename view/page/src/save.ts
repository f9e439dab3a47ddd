import { send } from "./connection";
import { get } from "./dom";
import { on } from "./page";
import { Popover } from "./popover";
import { fileName } from "./scenario";
import { picture } from "./scene/picture";
import { copy, download, toast } from "./toast";

/** The menu that saves a picture, the last minute as a replay or a recording, or a link. */
export const saveMenu = new Popover(get("save-open"), get("save"));
new Popover(get("scenario-open"), get("scenario"));

const item = (id: string, act: () => void) =>
  (get(id).onclick = () => {
    saveMenu.close();
    act();
  });
item("save-png", () => void picture().then((blob) => download(`${fileName()}.png`, blob, blob.type)));
for (const what of ["replay", "recording"])
  item("save-" + what, () => {
    toast(`Saving a ${what} of the last minute …`);
    send({ do: "save", what });
  });
item("save-link", () => copy(location.href, "a link"));

// Saves a file that the server has made.
on("file", ({ name, content }) => {
  const type = name.endsWith(".html") ? "text/html" : "application/octet-stream";
  download(name, content as BlobPart, type);
  toast(`Saved ${name}, ${(content.length / 1e6).toFixed(1)} MB.`);
});
