/** The element of the page with this id. */
export const get = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

/** Elements that a selector finds. */
export const all = <T extends HTMLElement>(selector: string) => document.querySelectorAll<T>(selector);

/** Creates an element with these properties and children. */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Partial<HTMLElementTagNameMap[K]> = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

/** Shows whether a button is pressed. */
export function press(button: HTMLElement, on: boolean) {
  button.classList.toggle("on", on);
  button.setAttribute("aria-pressed", String(on));
}

/** HTML that is ready to be shown. */
export class Markup {
  constructor(readonly text: string) {}
}

const entities: Record<string, string> = {
  "&": "&amp;",
  "<": "&lt;",
  ">": "&gt;",
  '"': "&quot;",
  "'": "&#39;",
};

function escaped(value: unknown): string {
  if (value instanceof Markup) return value.text;
  if (Array.isArray(value)) return value.map(escaped).join("");
  return String(value).replace(/[&<>"']/g, (character) => entities[character]);
}

/** HTML from a template. Values are escaped, since names come from files; markup is not. */
export function html(parts: TemplateStringsArray, ...values: unknown[]): Markup {
  return new Markup(parts.map((part, i) => part + (i < values.length ? escaped(values[i]) : "")).join(""));
}
