import { get } from "./dom";
import { ask, send } from "./page";
import type { Hello, State } from "./protocol";
import { toast } from "./toast";

const numbers = ["obstacles", "opponents"];

function fill(id: string, names: string[], none = "") {
  get(id).replaceChildren(...names.map((name) => new Option(name || none, name)));
}
function choose(id: string, value: string) {
  const select = get<HTMLSelectElement>(id);
  if (![...select.options].some((option) => option.value === value)) select.append(new Option(value, value));
  if (document.activeElement !== select) select.value = value;
}

/** The fields of the scenario, in the header and in its sheet. */
export class ScenarioFields {
  constructor() {
    // A field keeps what was typed while it is not valid.
    for (const key of ["course", "config", "seed", ...numbers]) {
      const field = get<HTMLInputElement>(key);
      const mark = (isBad: boolean) => field.setAttribute("aria-invalid", String(isBad));
      field.onchange = async () => {
        const value = numbers.includes(key) ? Number(field.value) : field.value;
        try {
          await ask({ do: "scenario", [key]: value });
          mark(false);
        } catch (error) {
          mark(true);
          toast((error as Error).message, true);
        }
      };
    }
    for (const key of ["method", "ghost"])
      get(key).onchange = () => send({ do: key, method: get<HTMLSelectElement>(key).value });
    get("rate").onchange = () => send({ do: "rate", rate: Number(get<HTMLSelectElement>("rate").value) });
    get("real-time").onchange = () =>
      send({ do: "real_time", on: get<HTMLInputElement>("real-time").checked });
  }

  /** Fills in the choices. */
  offer(hello: Hello) {
    fill("course", hello.courses);
    fill("method", hello.methods);
    fill("config", hello.configurations);
    fill("ghost", ["", ...hello.methods], "none");
  }

  show(state: State) {
    for (const key of ["course", "method", "config", "ghost"] as const) choose(key, state[key]);
    for (const key of ["seed", "obstacles", "opponents"] as const) {
      const input = get<HTMLInputElement>(key);
      if (document.activeElement !== input && input.ariaInvalid !== "true") input.value = String(state[key]);
    }
    get<HTMLSelectElement>("rate").value = String(state.rate);
    get<HTMLInputElement>("real-time").checked = state.real_time;
  }
}
