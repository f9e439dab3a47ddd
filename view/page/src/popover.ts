/** A panel that a button opens and closes. Escape and a click elsewhere close it, too. */
export class Popover {
  constructor(
    private readonly button: HTMLElement,
    private readonly panel: HTMLElement,
  ) {
    button.setAttribute("aria-expanded", "false");
    button.setAttribute("aria-controls", panel.id);
    panel.hidden = true;
    button.addEventListener("click", () => this.toggle());
    document.addEventListener("pointerdown", (event) => {
      const at = event.target as Node;
      if (!panel.contains(at) && !button.contains(at)) this.close();
    });
    for (const part of [button, panel])
      part.addEventListener("keydown", (event) => {
        if (event.key === "Escape" && !panel.hidden) {
          this.close();
          button.focus();
          event.stopPropagation();
        }
      });
  }

  toggle() {
    if (!this.panel.hidden) return this.close();
    this.panel.hidden = false;
    this.button.setAttribute("aria-expanded", "true");
    this.panel.querySelector<HTMLElement>("button, select, input")?.focus();
  }

  close() {
    this.panel.hidden = true;
    this.button.setAttribute("aria-expanded", "false");
  }
}
