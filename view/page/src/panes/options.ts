import type { OptionDeclaration, Options } from "../protocol";

/** A slider's travel in [0, 1] and the option's value; logarithmic where the range spans decades. */
function travel(o: OptionDeclaration) {
  const preset = Number(o.default.replace(/[[\]]/g, "").split(",")[0]), whole = o.type === "integer" || o.type === "count";
  const reference = Number.isFinite(preset) && preset !== 0 ? Math.abs(preset) : 1;
  let low = o.min ?? -Infinity, high = o.max ?? Infinity;
  // Beyond a hundred times the default nothing is worth a slider; the number field takes it.
  high = Math.min(high, whole ? Math.max(16, reference * 16) : reference * 20);
  low = Math.max(low, low < 0 ? -reference * 20 : 0);
  const logarithmic = low >= 0 && high / Math.max(low, reference / 1000) > 50;
  const floor = logarithmic ? Math.max(low, whole ? 1 : reference / 200) : low;
  return {
    to(value: number) { return logarithmic ? (value <= floor ? 0 : Math.log(value / floor) / Math.log(high / floor)) : (value - low) / (high - low); },
    from(at: number) {
      const v = logarithmic ? (at <= 0 && low === 0 && !whole ? 0 : floor * (high / floor) ** at) : low + at * (high - low);
      return whole ? Math.round(v) : Number(v.toPrecision(3));
    },
  };
}

/** The options that are changed most often; those that were changed are shown as well. */
const short = ["samples", "horizon", "temperature", "variance", "guides", "restart_variance", "adapt_covariance", "use_nominal", "vehicle.body_margin", "planner.max_speed"];

/** Sliders made from the options' declarations. */
export class OptionsPane {
  private readonly list: HTMLElement;
  private filter = "";
  private all = false;
  private last?: Options;

  constructor(private readonly root: HTMLElement, private readonly send: (command: Record<string, unknown>) => void, actions: { copy(text: string, what: string): void; save(yaml: string): void; load(): void }) {
    root.innerHTML = `<div class="row"><input type="text" id="filter" placeholder="Search all options" aria-label="Search all options" style="flex:1">
      <button id="undo" title="Undo (Ctrl+Z)">Undo</button><button id="redo" title="Redo (Ctrl+Y)">Redo</button><button id="reset">Reset</button></div>
      <div class="row"><button id="save-preset" title="What differs from the configuration, as a YAML file">Save preset</button><button id="load-preset">Load preset…</button><button id="copy-yaml">Copy as YAML</button><button id="copy-command">Copy as command line</button></div><pre id="command"></pre>
      <div id="option-list"></div><button id="all-options" aria-expanded="false"></button>`;
    this.list = root.querySelector("#option-list")!;
    const on = (id: string, act: () => void) => ((root.querySelector(id) as HTMLElement).onclick = act);
    on("#undo", () => send({ do: "undo" }));
    on("#redo", () => send({ do: "redo" }));
    on("#reset", () => send({ do: "reset_options" }));
    on("#copy-yaml", () => this.last && actions.copy(this.last.yaml, "YAML"));
    on("#copy-command", () => this.last && actions.copy(this.last.command_line, "command line"));
    on("#save-preset", () => this.last && actions.save(this.last.yaml));
    on("#load-preset", () => actions.load());
    on("#all-options", () => { this.all = !this.all; if (this.last) this.show(this.last); });
    (root.querySelector("#filter") as HTMLInputElement).oninput = (e) => {
      this.filter = (e.target as HTMLInputElement).value.toLowerCase();
      if (this.last) this.show(this.last);
    };
  }

  show(options: Options) {
    this.last = options;
    (this.root.querySelector("#undo") as HTMLButtonElement).disabled = options.undo === 0;
    (this.root.querySelector("#redo") as HTMLButtonElement).disabled = options.redo === 0;
    (this.root.querySelector("#reset") as HTMLButtonElement).disabled = options.changed.length === 0;
    this.root.querySelector("#command")!.textContent = options.command_line;
    const parts: HTMLElement[] = [];
    for (const section of options.sections) {
      const shown = section.options.filter((o) => this.shows(section.name, o));
      if (!shown.length) continue;
      const head = document.createElement("div");
      head.className = "section";
      head.textContent = section.name;
      parts.push(head, ...shown.map((o) => this.row(section.name, o)));
    }
    const more = this.root.querySelector<HTMLElement>("#all-options")!, count = options.sections.reduce((n, s) => n + s.options.length, 0);
    more.hidden = this.filter !== "";
    more.textContent = this.all ? "Fewer options" : `All ${count} options`;
    more.setAttribute("aria-expanded", String(this.all));
    if (!parts.length) parts.push(Object.assign(document.createElement("p"), { textContent: `No option matches '${this.filter}'.` }));
    const at = this.root.scrollTop;
    this.list.replaceChildren(...parts);
    this.root.scrollTop = at;
  }

  private shows(section: string, o: OptionDeclaration) {
    if (this.filter) return `${section} ${o.name} ${o.help} ${o.symbol}`.toLowerCase().includes(this.filter);
    return this.all || o.value !== o.default || short.includes(`${section}.${o.name}`) || (section !== "vehicle" && section !== "planner" && short.includes(o.name));
  }

  private row(section: string, o: OptionDeclaration): HTMLElement {
    const key = `${section}.${o.name}`, row = document.createElement("div"), label = document.createElement("label"), set = (value: string) => this.send({ do: "set", key, value });
    row.className = "option" + (o.value !== o.default ? " changed" : "");
    row.dataset.key = key;
    label.textContent = o.name;
    label.htmlFor = key;
    const aside = [o.symbol, o.unit && `[${o.unit}]`].filter(Boolean).join(" ");
    if (aside) { const small = document.createElement("small"); small.textContent = aside; label.append(small); }
    row.append(label);
    if (o.type === "flag") {
      const box = document.createElement("input");
      box.type = "checkbox"; box.id = key; box.checked = o.value === "true";
      box.onchange = () => set(String(box.checked));
      row.append(box);
    } else if (o.type === "choice") {
      const select = document.createElement("select");
      select.id = key;
      for (const c of o.choices ?? []) select.append(new Option(c, c, false, c === o.value));
      select.onchange = () => set(select.value);
      row.append(select);
    } else {
      const text = document.createElement("input");
      text.type = "text"; text.id = key; text.value = o.value; text.className = "numbers"; text.inputMode = "decimal";
      text.onchange = () => set(text.value);
      row.append(text);
      const value = Number(o.value.replace(/[[\]]/g, ""));
      if (Number.isFinite(value)) {
        const t = travel(o), slider = document.createElement("input");
        slider.type = "range"; slider.min = "0"; slider.max = "1"; slider.step = "0.001"; slider.value = String(t.to(value));
        slider.setAttribute("aria-label", o.name);
        slider.oninput = () => (text.value = String(t.from(Number(slider.value))));
        slider.onchange = () => set(String(t.from(Number(slider.value)))); // on release
        row.append(slider);
      }
    }
    const help = document.createElement("p");
    const range = [o.min, o.max].some((v) => v !== undefined && Math.abs(v) < 1e6) ? ` (${o.min ?? "−∞"} … ${o.max !== undefined && o.max < 1e9 ? o.max : "∞"})` : "";
    help.textContent = o.help + range;
    row.append(help);
    return row;
  }
}
