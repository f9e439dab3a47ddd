import { get, make } from "./dom";
import { solver } from "./page";
import { costTerms, layers } from "./scene/layers";

/** Icons of 16 x 16 for buttons whose text does not fit on narrow screens. */
const icons = {
  play: "M4 2.5v11l9-5.5z",
  pause: "M4 3h3v10H4zM9 3h3v10H9z",
  step: "M3 3l7 5-7 5zM11 3h2v10h-2z",
  fork: "M4 14V9l4-3V2h2v4.8L6 9.8V14zM10.400 9l2.600 2v3h-2v-2l-1.800-1.400z",
  restart: "M8 2a6 6 0 1 0 6 6h-2a4 4 0 1 1-4-4v3l5-4-5-4z",
};

export function icon(name: keyof typeof icons): string {
  const path = `<path fill="currentColor" d="${icons[name]}"/>`;
  return `<svg class="icon" viewBox="0 0 16 16" aria-hidden="true">${path}</svg>`;
}

/** Layers that only a car on a course has. */
const ofCar = ["costMap", "path", "scan", "opponents", "modes", "ghost"];

/** Fills in the parts of the page that follow from lists: icons and layers. */
export function fillLists() {
  if (solver) leaveCarOut(); // it has problems alone, and takes a moment to say which
  for (const button of document.querySelectorAll<HTMLElement>("[data-icon]"))
    button.insertAdjacentHTML("afterbegin", icon(button.dataset.icon as keyof typeof icons));
  for (const [name, title, text] of layers) {
    const box = make("input", { type: "checkbox", checked: true });
    box.dataset.layer = name;
    const swatch = make("span", { className: "swatch" });
    swatch.dataset.swatch = name;
    const className = solver && ofCar.includes(name) ? "empty" : "";
    get("layer-list").append(make("label", { title: text, className }, box, title, swatch));
  }
}

/** Offers the terms of the cost. */
export function fillTerms() {
  const options = costTerms().map((term) => {
    const text = term[0].toUpperCase() + term.slice(1) + " cost";
    return new Option(text, term, term === "total", term === "total");
  });
  get("term").replaceChildren(...options, new Option("Density", "density"));
}

/** Hides what only a car on a course has. */
function leaveCarOut() {
  document.body.classList.add("own");
  if (solver && self !== top) {
    document.body.classList.add("framed");
    get("scenario-menu").before(get("primary"));
  }
  document.querySelector('[data-follow="fit"]')!.textContent = "Fit";
}

/** Gives the page the name of a problem of the user's own. */
export function nameProblem({ title }: { title: string }) {
  leaveCarOut();
  document.title = title;
  get("caption").hidden = false;
  get("caption").textContent = get("caption").title = title;
  get("scene").setAttribute("aria-label", `The scene of ${title}, and the plans of the controller`);
}

/** Puts course, method and ghost into the header where there is room, else into the sheet of the scenario. */
export function foldHeader() {
  const narrow = matchMedia("(max-width: 1099px)");
  const fold = () => {
    if (narrow.matches) get("primary-folded").append(get("primary"));
    else get("scenario-menu").before(get("primary"));
  };
  narrow.addEventListener("change", fold);
  fold();
}
