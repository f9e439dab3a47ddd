import { ask, send } from "../connection";
import { click, get } from "../dom";
import { can, page } from "../page";

// Asks what is to drive on from the tick that is shown.

const box = get<HTMLDialogElement>("fork-box");
const method = get<HTMLSelectElement>("fork-method");
const text = get<HTMLInputElement>("fork-options");

function tellError(problem: string) {
  get("fork-error").textContent = problem;
  get("fork-error").hidden = !problem;
}

function showKeys() {
  const own = page.options?.sections.find((s) => s.name === method.value);
  const names = own ? `Options of ${own.name}: ${own.options.map((o) => o.name).join(", ")}. ` : "";
  get("fork-keys").textContent = names + "Others as section.option=value.";
}
method.onchange = showKeys;

/** Pauses and opens the dialog. */
export function openFork() {
  const { hello, state } = page;
  if (!hello || !state || !can("ghost")) return;
  if (!state.paused) send({ do: "pause" });
  const { methods } = hello;
  const choices = methods.map((m) => new Option(m === state.method ? `${m} (present)` : m, m));
  method.replaceChildren(...choices);
  method.value = state.ghost || (methods.find((m) => m !== state.method) ?? state.method);
  text.value = "";
  showKeys();
  tellError("");
  box.showModal();
}
click("fork", openFork);

// The box stays open, with what was typed, unless the fork succeeds.
box.querySelector("form")!.onsubmit = (event) => {
  if ((event.submitter as HTMLButtonElement).value !== "go") return;
  event.preventDefault();
  const words = text.value.trim().split(/\s+(?=[\w.]+=)/);
  ask({ do: "fork", method: method.value, set: words.filter(Boolean) }).then(
    () => box.close(),
    (error: Error) => tellError(error.message),
  );
};
