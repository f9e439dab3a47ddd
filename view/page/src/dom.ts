/** The element of the page with this id. */
export const get = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

/** Elements that a selector finds. */
export const all = <T extends HTMLElement>(selector: string) => document.querySelectorAll<T>(selector);

/** Calls a function when the element with this id is clicked. */
export const click = (id: string, act: () => void) => (get(id).onclick = act);

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

/** Changes a text where it differs: the same text again would cost another layout. */
export function say(node: Node, text: string) {
  if (node.textContent !== text) node.textContent = text;
}

/** Shows whether a button is pressed. */
export function press(button: HTMLElement, on: boolean) {
  button.classList.toggle("on", on);
  button.setAttribute("aria-pressed", String(on));
}

/** A number with its noun: "1 lap", "2 laps". */
export const counted = (n: number, noun: string) => `${n} ${noun}${n === 1 ? "" : "s"}`;

/** Icons of 16 x 16 for buttons whose text does not fit on narrow screens. */
const icons = {
  play: "M4 2.5v11l9-5.5z",
  pause: "M4 3h3v10H4zM9 3h3v10H9z",
  step: "M3 3l7 5-7 5zM11 3h2v10h-2z",
  fork: "M4 14V9l4-3V2h2v4.8L6 9.8V14zM10.400 9l2.600 2v3h-2v-2l-1.800-1.400z",
  restart: "M8 2a6 6 0 1 0 6 6h-2a4 4 0 1 1-4-4v3l5-4-5-4z",
};

/** Puts an icon before the text of a button. */
export function showIcon(button: HTMLElement, name = button.dataset.icon as keyof typeof icons) {
  const path = `<path fill="currentColor" d="${icons[name]}"/>`;
  button.querySelector("svg")?.remove();
  const icon = `<svg class="icon" viewBox="0 0 16 16" aria-hidden="true">${path}</svg>`;
  button.insertAdjacentHTML("afterbegin", icon);
}
