import { send } from "../connection";
import { click, get, make } from "../dom";
import { can, on, page } from "../page";
import type { OptionDeclaration } from "../protocol";
import { copy } from "../toast";

/** Between a slider's travel in [0, 1] and the option's value; logarithmic where the range spans decades. */
function travel(o: OptionDeclaration) {
  const preset = Number(o.default.replace(/[[\]]/g, "").split(",")[0]);
  const isWhole = o.type === "integer" || o.type === "count";
  const reference = Number.isFinite(preset) && preset !== 0 ? Math.abs(preset) : 1;
  // The number field takes what is far beyond the default.
  const high = Math.min(o.max ?? Infinity, isWhole ? Math.max(16, reference * 16) : reference * 20);
  const least = o.min ?? -Infinity;
  const low = Math.max(least, least < 0 ? -reference * 20 : 0);
  const round = (v: number) => (isWhole ? Math.round(v) : Number(v.toPrecision(3)));
  if (low < 0 || high / Math.max(low, reference / 1000) <= 50)
    return {
      to: (value: number) => (value - low) / (high - low),
      from: (at: number) => round(low + at * (high - low)),
    };
  const floor = Math.max(low, isWhole ? 1 : reference / 200);
  return {
    to: (value: number) => (value <= floor ? 0 : Math.log(value / floor) / Math.log(high / floor)),
    from: (at: number) => (at <= 0 && low === 0 && !isWhole ? 0 : round(floor * (high / floor) ** at)),
  };
}

const greekNames = "alpha beta gamma epsilon lambda mu nu rho sigma Sigma tau theta phi psi".split(" ");
const greekLetters = "αβγελμνρσΣτθφψ";
/** The symbol of a formula, with its Greek letters. */
const symbol = (name: string) =>
  name.replace(/[A-Za-z]+/g, (word) => greekLetters[greekNames.indexOf(word)] ?? word);

/** The options that are changed most often; those that were changed are shown as well. */
const short = `samples horizon temperature variance guides restart_variance adapt_covariance use_nominal
  vehicle.body_margin planner.max_speed`.split(/\s+/);

export const undo = () => send({ do: "undo" });
export const redo = () => send({ do: "redo" });
click("undo", undo);
click("redo", redo);
click("reset", () => send({ do: "reset_options" }));
click("copy-yaml", () => page.options && copy(page.options.yaml, "YAML"));
click("copy-command", () => page.options && copy(page.options.command_line, "command line"));

let showsAll = false;
click("all-options", () => {
  showsAll = !showsAll;
  show();
});
let filter = "";
const search = get<HTMLInputElement>("filter");
search.oninput = () => {
  filter = search.value.toLowerCase();
  show();
};
on("options", show);

/** Shows the controls that are made from the declarations of the options. */
function show() {
  const { options } = page;
  if (!options) return;
  get<HTMLButtonElement>("undo").disabled = options.undo === 0;
  get<HTMLButtonElement>("redo").disabled = options.redo === 0;
  get<HTMLButtonElement>("reset").disabled = options.changed.length === 0;
  for (const id of ["command", "copy-command"]) get(id).hidden = !options.command_line;
  get("command").textContent = options.command_line;
  get("option-list").inert = !can("live");
  const parts = options.sections.flatMap(({ name, options }) => {
    const shown = options.filter((o) => isShown(name, o)).map((o) => rowOf(name, o));
    return shown.length ? [make("div", { className: "section" }, name), ...shown] : [];
  });
  if (!parts.length) parts.push(make("div", {}, `No option matches '${filter}'.`));
  const count = options.sections.reduce((n, s) => n + s.options.length, 0);
  const more = get("all-options");
  more.hidden = filter !== "";
  more.textContent = showsAll ? "Fewer options" : `All ${count} options`;
  more.setAttribute("aria-expanded", String(showsAll));
  const pane = get("pane-options");
  const scrolled = pane.scrollTop;
  get("option-list").replaceChildren(...parts);
  pane.scrollTop = scrolled;
}

function isShown(section: string, o: OptionDeclaration) {
  if (filter) return `${section} ${o.name} ${o.help} ${o.symbol}`.toLowerCase().includes(filter);
  const isOfMethod = section !== "vehicle" && section !== "planner";
  const isShort = short.includes(`${section}.${o.name}`) || (isOfMethod && short.includes(o.name));
  return showsAll || o.value !== o.default || isShort;
}

function rowOf(section: string, o: OptionDeclaration): HTMLElement {
  const key = `${section}.${o.name}`;
  const aside = [symbol(o.symbol), o.unit && `[${o.unit.replace("^2", "²")}]`].filter(Boolean).join(" ");
  const isBounded = [o.min, o.max].some((v) => v !== undefined && Math.abs(v) < 1e6);
  const upper = o.max !== undefined && o.max < 1e9 ? o.max : "∞";
  const range = isBounded ? ` (${o.min ?? "−∞"} … ${upper})` : "";
  const row = make(
    "div",
    { className: "option" + (o.value !== o.default ? " changed" : "") },
    make("label", { htmlFor: key }, o.name, make("small", {}, aside)),
    ...controlsOf(key, o),
    make("p", {}, o.help + range),
  );
  row.dataset.key = key;
  return row;
}

function controlsOf(key: string, o: OptionDeclaration): HTMLElement[] {
  const set = (value: string) => send({ do: "set", key, value });
  if (o.type === "flag") {
    const box = make("input", { type: "checkbox", id: key, checked: o.value === "true" });
    box.onchange = () => set(String(box.checked));
    return [box];
  }
  if (o.type === "choice") {
    const choices = (o.choices ?? []).map((c) => new Option(c, c, false, c === o.value));
    const select = make("select", { id: key }, ...choices);
    select.onchange = () => set(select.value);
    return [select];
  }
  const text = make("input", { type: "text", id: key, value: o.value, className: "numbers" });
  text.inputMode = "decimal";
  text.onchange = () => set(text.value);
  const value = Number(o.value.replace(/[[\]]/g, ""));
  if (!Number.isFinite(value)) return [text];
  const t = travel(o);
  const slider = make("input", { type: "range", min: "0", max: "1", step: "0.001", ariaLabel: o.name });
  slider.value = String(t.to(value));
  slider.oninput = () => (text.value = String(t.from(Number(slider.value))));
  slider.onchange = () => set(text.value);
  return [text, slider];
}
