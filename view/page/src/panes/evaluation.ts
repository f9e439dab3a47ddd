import { counted, get, make } from "../dom";
import { send } from "../page";
import type { Evaluation, EvaluationLap, State } from "../protocol";

/** A list of an evaluation's laps; a click on a collision shows the two seconds before it. */
export class EvaluationPane {
  private evaluation?: Evaluation;
  private experiment = 0;
  private shown = "";

  private readonly select = get<HTMLSelectElement>("experiment");
  private readonly only = get<HTMLInputElement>("only-contacts");

  /** `changed`: the marks are others. */
  constructor(private readonly changed: () => void) {
    this.select.onchange = () => {
      this.experiment = Number(this.select.value);
      this.render();
    };
    this.only.onchange = () => this.render();
  }

  show(evaluation: Evaluation) {
    this.evaluation = evaluation;
    const worst = evaluation.experiments.map((_, i) => this.laps(i).reduce((n, l) => n + l.points.length, 0));
    this.experiment = Math.max(0, worst.indexOf(Math.max(...worst)));
    this.render();
  }

  showState(state: State) {
    const shown = state.contact ? nameOf(state.contact, state.contact.contact) : "";
    if (shown === this.shown) return;
    this.shown = shown;
    this.render();
  }

  private laps(experiment: number): EvaluationLap[] {
    return this.evaluation!.laps.filter((l) => l.experiment === experiment);
  }

  /** The collisions of the chosen experiment, which are drawn on the map and can be clicked. */
  marks(): { x: number; y: number; lap: EvaluationLap; contact: number; shown: boolean }[] {
    if (!this.evaluation) return [];
    return this.laps(this.experiment).flatMap((lap) =>
      lap.points.map(([x, y], i) => ({ x, y, lap, contact: i, shown: this.shown === nameOf(lap, i) })),
    );
  }

  go(lap: EvaluationLap, contact: number) {
    send({ do: "lap", experiment: lap.experiment, lap: lap.lap, contact });
  }

  private render() {
    const evaluation = this.evaluation;
    if (!evaluation) return;
    const laps = this.laps(this.experiment);
    const contacts = laps.reduce((n, l) => n + l.points.length, 0);
    const finished = laps.filter((l) => l.finished).length;
    get("evaluation-folder").textContent =
      `${evaluation.folder}: ${counted(evaluation.laps.length, "lap")} on ${evaluation.course}.`;
    get("evaluation-counts").textContent =
      `${counted(laps.length, "lap")}, ${finished} finished, ${counted(contacts, "collision")}`;
    const names = evaluation.experiments.map((e) => `${e.label} · ${e.scenario}`);
    this.select.replaceChildren(...names.map((name, i) => new Option(name, String(i))));
    this.select.value = String(this.experiment);
    get("evaluation-hint").textContent = contacts
      ? "Click a collision, here or on the map, to see the two seconds before it."
      : "No lap of this experiment has a collision. Click a number to drive its lap.";
    get("only-contacts-line").hidden = contacts === 0;
    const shown = laps.filter((lap) => lap.points.length || !this.only.checked || contacts === 0);
    get("evaluation-laps").replaceChildren(...shown.map((lap) => this.row(lap)));
    this.changed();
  }

  private row(lap: EvaluationLap): HTMLElement {
    const whole = make("button", { title: "drive this lap from its start" }, String(lap.lap));
    whole.onclick = () => this.go(lap, -1);
    const collisions = lap.points.flatMap(([x, y], i) => {
      const button = make("button", {}, `${x.toFixed(1)}, ${y.toFixed(1)} m`);
      button.dataset.contact = nameOf(lap, i);
      button.className = nameOf(lap, i) === this.shown ? "on" : "";
      button.onclick = () => this.go(lap, i);
      return [button, " "];
    });
    const time = make("td", { className: "n" }, lap.finished ? lap.time.toFixed(2) : "not finished");
    return make("tr", {}, make("td", {}, whole), time, make("td", {}, ...collisions));
  }
}

/** A collision of a lap as a text to compare. */
const nameOf = (lap: { experiment: number; lap: number }, contact: number) =>
  `${lap.experiment}/${lap.lap}/${contact}`;
