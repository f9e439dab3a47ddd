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

/** A number with its noun: "1 lap", "2 laps". */
export const counted = (n: number, noun: string) => `${n} ${noun}${n === 1 ? "" : "s"}`;
