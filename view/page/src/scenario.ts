import { ask, send } from "./connection";
import { counted, get } from "./dom";
import { can, isReplay, on, page, solver } from "./page";
import type { State } from "./protocol";
import { toast } from "./toast";

// The scenario: its fields in the header and in its sheet, and the address: #course=stag&seed=3&set=mppi.samples=500.

const chosen = ["course", "method", "config", "ghost"] as const;
const typed = ["seed", "obstacles", "opponents"] as const;
const counts: string[] = typed.slice(1);
const field = (key: string) => get<HTMLInputElement>(key);

function fill(id: string, names: string[], none = "") {
  get(id).replaceChildren(...names.map((name) => new Option(name || none, name)));
}

// A field keeps what was typed while it is not valid.
for (const key of ["course", "config", ...typed])
  field(key).onchange = async () => {
    const { value } = field(key);
    const mark = (isBad: boolean) => field(key).setAttribute("aria-invalid", String(isBad));
    try {
      await ask({ do: "scenario", [key]: counts.includes(key) ? Number(value) : value });
      mark(false);
    } catch (error) {
      mark(true);
      toast((error as Error).message, true);
    }
  };
for (const key of ["method", "ghost"])
  field(key).onchange = () => send({ do: key, method: field(key).value });
field("real-time").onchange = () => send({ do: "real_time", on: field("real-time").checked });

function show(state: State) {
  for (const key of chosen) {
    const select = get<HTMLSelectElement>(key);
    const isOffered = [...select.options].some(({ value }) => value === state[key]);
    if (!isOffered) select.append(new Option(state[key], state[key]));
    if (document.activeElement !== select) select.value = state[key];
  }
  for (const key of typed)
    if (document.activeElement !== field(key) && field(key).ariaInvalid !== "true")
      field(key).value = String(state[key]);
  field("real-time").checked = state.real_time;
}

/** Names of course, method, ghost, seed and obstacles, in a few words. */
export function titleParts(): string[] {
  const { state } = page;
  if (!state) return [];
  const parts = [state.course || page.hello!.title, state.method];
  if (state.ghost) parts.push(`against ${state.ghost_label || state.ghost}`);
  if (state.course) parts.push(`seed ${state.seed}`, counted(state.obstacles, "obstacle"));
  if (state.opponents) parts.push(counted(state.opponents, "opponent"));
  return parts;
}

/** The beginning of the names of files that are saved. */
export const fileName = () => `slalom-${titleParts()[0]}-${page.state?.tick}`;

// Course, method and ghost are in the header where there is room, else in the sheet of the scenario.
const narrow = matchMedia("(max-width: 1099px)");
const isFramed = solver !== undefined && self !== top; // inside a page of the documentation
document.body.classList.toggle("framed", isFramed);
function fold() {
  const isFolded = narrow.matches && !isFramed;
  if (isFolded) get("primary-folded").append(get("primary"));
  else get("scenario-menu").before(get("primary"));
  get("scenario-menu").hidden = !can("live") || !(isFolded || can("scenario"));
}
narrow.addEventListener("change", fold);
fold();

const wanted = new URLSearchParams(location.hash.slice(1)); // scenario in the address, still to be set
const forget = () => [...wanted.keys()].forEach((key) => wanted.delete(key));
const changed = () => page.options?.changed ?? [];

/** Sends the commands that lead from the state to the scenario of the address. */
function apply(now: State) {
  const scenario: Record<string, unknown> = {};
  for (const key of ["course", "method", "config", "seed"] as const)
    if (wanted.has(key) && wanted.get(key) !== now[key]) scenario[key] = wanted.get(key);
  for (const key of ["obstacles", "opponents"] as const)
    if (wanted.has(key) && Number(wanted.get(key)) !== now[key]) scenario[key] = Number(wanted.get(key));
  if (Object.keys(scenario).length) send({ do: "scenario", ...scenario });
  for (const each of wanted.getAll("set")) {
    const equals = each.indexOf("=");
    if (equals > 0 && !changed().includes(each))
      send({ do: "set", key: each.slice(0, equals), value: each.slice(equals + 1) });
  }
  const ghost = wanted.get("against");
  if (ghost && ghost !== now.ghost) send({ do: "ghost", method: ghost });
  forget();
}

/** Puts the scenario into the address, so that it can be shared as a link. */
function showAddress() {
  const { state } = page;
  if (!state || !can("scenario") || wanted.size) return;
  const { course, method, config, seed, obstacles, opponents, ghost } = state;
  const words = new URLSearchParams({ course, method, config, seed, obstacles: String(obstacles) });
  if (opponents) words.set("opponents", String(opponents));
  if (ghost) words.set("against", ghost);
  for (const each of changed()) words.append("set", each);
  const address = words.toString().replace(/%3D/g, "=").replace(/%5B/g, "[").replace(/%5D/g, "]");
  history.replaceState(null, "", `${location.pathname}${location.search}#${address}`);
}

on("role", ({ drives }) => !drives && forget());
on("options", showAddress);
on("hello", (hello) => {
  fill("course", hello.courses);
  fill("method", hello.methods);
  fill("config", hello.configurations);
  fill("ghost", ["", ...hello.methods], "none");
  fold();
  if (!can("scenario")) forget();
});
on("state", (state) => {
  show(state);
  if (wanted.size) apply(state);
  showAddress();
  const caption = isReplay ? titleParts().join(" · ") : page.hello!.title;
  get("caption").hidden = can("scenario");
  get("caption").textContent = get("caption").title = caption;
  if (!can("scenario")) document.title = caption;
});
