/** What a preset sets: the configuration that it starts from, if it names one, and section.option=value of the others. */
export interface Preset { base?: string; set: string[] }

/**
 * Reads a preset: the YAML of a configuration file with one option on each line. Throws an error that names the line.
 */
export function parsePreset(text: string): Preset {
  const preset: Preset = { set: [] };
  let section = "";
  text.split(/\r?\n/).forEach((whole, i) => {
    const line = whole.replace(/(^|\s)#.*$/, "").trimEnd(), found = line.match(/^(\s*)([A-Za-z_]\w*):(?:\s+(\S.*))?$/);
    if (!line || line === "---") return;
    const fail = (rule: string) => { throw new Error(`Line ${i + 1}: '${whole.trim()}' ${rule}.`); };
    if (!found) return fail("must be section:, option: value or base: name");
    const [, indent, key, value] = found, plain = value?.replace(/^(["'])(.*)\1$/, "$2");
    if (indent) {
      if (!section) fail("must stand under a section");
      if (plain === undefined) fail("must have its value on the same line");
      preset.set.push(`${section}.${key}=${plain}`);
    } else if (key === "base") {
      if (plain === undefined) fail("must name a configuration");
      preset.base = plain;
    } else {
      if (plain !== undefined) fail("must be a section, whose options follow on indented lines");
      section = key;
    }
  });
  return preset;
}

/** Asks for a preset, as text or as a file, and applies it. It keeps what was typed until that has succeeded. */
export class PresetBox {
  constructor(private readonly box: HTMLDialogElement, private readonly apply: (preset: Preset) => Promise<void>) {
    box.innerHTML = `<form method="dialog"><h2 id="preset-title">Load a preset</h2>
      <p>The YAML that "Save preset" writes: a configuration and the options that differ from it. <code>--config FILE</code> takes the same file.</p>
      <input type="file" id="preset-file" accept=".yaml,.yml" aria-label="Preset file">
      <p><textarea id="preset-text" aria-label="Preset as YAML" spellcheck="false" placeholder="base: default"></textarea></p>
      <p id="preset-error" class="problem" role="alert" hidden></p>
      <div class="row end"><button value="cancel">Cancel</button><button id="preset-go" class="primary" value="go">Load</button></div></form>`;
    this.file.onchange = () => void this.file.files?.[0]?.text().then((text) => (this.text.value = text));
    box.querySelector("form")!.addEventListener("submit", (event) => {
      if ((event.submitter as HTMLButtonElement).value !== "go") return;
      event.preventDefault();
      void this.go();
    });
  }

  private get text() { return this.box.querySelector<HTMLTextAreaElement>("#preset-text")!; }
  private get file() { return this.box.querySelector<HTMLInputElement>("#preset-file")!; }

  open() { this.tell(""); this.box.showModal(); }

  private tell(problem: string) {
    const line = this.box.querySelector<HTMLElement>("#preset-error")!;
    line.textContent = problem;
    line.hidden = !problem;
  }

  private async go() {
    try {
      await this.apply(parsePreset(this.text.value));
      this.box.close();
    } catch (error) {
      this.tell((error as Error).message);
    }
  }
}
