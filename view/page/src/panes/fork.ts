import type { Hello, Options, State } from "../protocol";

/** Asks what is to drive on from the tick that is shown. */
export class ForkBox {
  private options?: Options;

  constructor(private readonly box: HTMLDialogElement, private readonly ask: (command: Record<string, unknown>) => Promise<void>) {
    box.innerHTML = `<form method="dialog"><h2 id="fork-title">Fork</h2>
      <p>Another controller continues from the control step shown. The present one continues as a ghost.</p>
      <label class="line"><span>Method</span><select id="fork-method"></select></label>
      <label class="line"><span>Options</span><input type="text" id="fork-options" placeholder="samples=512 temperature=1" spellcheck="false" autocomplete="off"></label>
      <p id="fork-keys"></p><p id="fork-error" class="problem" role="alert" hidden></p>
      <div class="row end"><button value="cancel" formnovalidate>Cancel</button><button id="fork-go" class="primary" value="go">Fork here</button></div></form>`;
    box.querySelector("form")!.addEventListener("submit", (event) => {
      if ((event.submitter as HTMLButtonElement).value !== "go") return;
      event.preventDefault(); // the box stays open, with what was typed, unless the fork succeeds
      void this.go();
    });
    this.method.onchange = () => this.showKeys();
  }

  private get method() { return this.box.querySelector<HTMLSelectElement>("#fork-method")!; }
  private get text() { return this.box.querySelector<HTMLInputElement>("#fork-options")!; }

  takeOptions(options: Options) { this.options = options; }

  open(hello: Hello, state: State) {
    this.method.replaceChildren(...hello.methods.map((m) => new Option(m === state.method ? `${m} (present)` : m, m)));
    this.method.value = state.ghost || (hello.methods.find((m) => m !== state.method) ?? state.method);
    this.text.value = "";
    this.showKeys();
    this.tell("");
    this.box.showModal();
  }

  private showKeys() {
    const own = this.options?.sections.find((s) => s.name === this.method.value);
    this.box.querySelector("#fork-keys")!.textContent = own ? `Options of ${own.name}: ${own.options.map((o) => o.name).join(", ")}. Others as section.option=value.` : "Options of the method by name, others as section.option=value.";
  }

  private tell(problem: string) {
    const line = this.box.querySelector<HTMLElement>("#fork-error")!;
    line.textContent = problem;
    line.hidden = !problem;
  }

  private async go() {
    const set = this.text.value.trim().split(/\s+(?=[\w.]+=)/).filter(Boolean);
    try {
      await this.ask({ do: "fork", method: this.method.value, set });
      this.box.close();
    } catch (error) {
      this.tell((error as Error).message);
    }
  }
}
