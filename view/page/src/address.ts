import { changedOptions, page, send } from "./page";
import type { State } from "./protocol";

// The address holds the scenario: #course=stag&method=mppi&seed=3&set=mppi.samples=500.

/** Sends the commands that lead from the state to the scenario of an address, and empties `wanted`. */
export function applyAddress(wanted: URLSearchParams) {
  const now = page.state!;
  const scenario: Record<string, unknown> = {};
  for (const key of ["course", "method", "config", "seed"] as const)
    if (wanted.has(key) && wanted.get(key) !== now[key]) scenario[key] = wanted.get(key);
  for (const key of ["obstacles", "opponents"] as const)
    if (wanted.has(key) && Number(wanted.get(key)) !== now[key]) scenario[key] = Number(wanted.get(key));
  const set = wanted.getAll("set");
  const ghost = wanted.get("against");
  for (const key of [...wanted.keys()]) wanted.delete(key);
  if (Object.keys(scenario).length) send({ do: "scenario", ...scenario });
  for (const each of set) {
    const equals = each.indexOf("=");
    if (equals > 0 && !changedOptions().includes(each))
      send({ do: "set", key: each.slice(0, equals), value: each.slice(equals + 1) });
  }
  if (ghost && ghost !== now.ghost) send({ do: "ghost", method: ghost });
}

/** The scenario as it stands in the address after the #, so that it can be shared as a link. */
export function addressOf(state: State): string {
  const words = new URLSearchParams({
    course: state.course,
    method: state.method,
    config: state.config,
    seed: state.seed,
    obstacles: String(state.obstacles),
  });
  if (state.opponents) words.set("opponents", String(state.opponents));
  if (state.ghost) words.set("against", state.ghost);
  for (const each of changedOptions()) words.append("set", each);
  return words.toString().replace(/%3D/g, "=").replace(/%5B/g, "[").replace(/%5D/g, "]");
}
