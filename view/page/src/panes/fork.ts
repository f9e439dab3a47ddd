import { get } from "../dom";
import { ask, page } from "../page";

/** Asks what is to drive on from the tick that is shown. */
export class ForkBox {
  private readonly box = get<HTMLDialogElement>("fork-box");
  private readonly method = get<HTMLSelectElement>("fork-method");
  private readonly text = get<HTMLInputElement>("fork-options");

  constructor() {
    this.box.querySelector("form")!.addEventListener("submit", (event) => {
      if ((event.submitter as HTMLButtonElement).value !== "go") return;
      event.preventDefault(); // the box stays open, with what was typed, unless the fork succeeds
      void this.go();
    });
    this.method.onchange = () => this.showKeys();
  }

  open() {
    const { methods } = page.hello!;
    const state = page.state!;
    const choices = methods.map((m) => new Option(m === state.method ? `${m} (present)` : m, m));
    this.method.replaceChildren(...choices);
    this.method.value = state.ghost || (methods.find((m) => m !== state.method) ?? state.method);
    this.text.value = "";
    this.showKeys();
    this.tell("");
    this.box.showModal();
  }

  private showKeys() {
    const own = page.options?.sections.find((s) => s.name === this.method.value);
    const names = own ? `Options of ${own.name}: ${own.options.map((o) => o.name).join(", ")}. ` : "";
    get("fork-keys").textContent = names + "Others as section.option=value.";
  }

  private tell(problem: string) {
    get("fork-error").textContent = problem;
    get("fork-error").hidden = !problem;
  }

  private async go() {
    const set = this.text.value
      .trim()
      .split(/\s+(?=[\w.]+=)/)
      .filter(Boolean);
    try {
      await ask({ do: "fork", method: this.method.value, set });
      this.box.close();
    } catch (error) {
      this.tell((error as Error).message);
    }
  }
}
