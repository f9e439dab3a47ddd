import { html, Markup } from "../html";
import type { Evaluation, EvaluationLap, State } from "../protocol";

/** A list of an evaluation's laps; a click on a collision shows the two seconds before it. */
export class EvaluationPane {
  private evaluation?: Evaluation;
  private experiment = 0;
  private onlyContacts = true;
  private shown = "";

  constructor(private readonly root: HTMLElement, private readonly send: (command: Record<string, unknown>) => void, private readonly changed: () => void) {}

  show(evaluation: Evaluation) {
    this.evaluation = evaluation;
    const worst = evaluation.experiments.map((_, i) => this.laps(i).reduce((n, l) => n + l.points.length, 0));
    this.experiment = Math.max(0, worst.indexOf(Math.max(...worst)));
    this.render();
  }

  showState(state: State) {
    const shown = state.contact ? `${state.contact.experiment}/${state.contact.lap}/${state.contact.contact}` : "";
    if (shown === this.shown) return;
    this.shown = shown;
    this.render();
  }

  private laps(experiment: number): EvaluationLap[] { return this.evaluation!.laps.filter((l) => l.experiment === experiment); }

  /** The collisions of the chosen experiment, which are drawn on the map and can be clicked. */
  marks(): { x: number; y: number; lap: EvaluationLap; contact: number; shown: boolean }[] {
    if (!this.evaluation) return [];
    return this.laps(this.experiment).flatMap((lap) => lap.points.map(([x, y], contact) => ({ x, y, lap, contact, shown: this.shown === `${lap.experiment}/${lap.lap}/${contact}` })));
  }

  go(lap: EvaluationLap, contact: number) { this.send({ do: "lap", experiment: lap.experiment, lap: lap.lap, contact }); }

  private render() {
    const all = this.evaluation;
    if (!all) return;
    const laps = this.laps(this.experiment), contacts = laps.reduce((n, l) => n + l.points.length, 0), finished = laps.filter((l) => l.finished).length;
    this.root.innerHTML = html`<p>${all.folder}: ${all.laps.length} laps on ${all.course}. Click a collision, here or on the map, to drive its lap again and see the two seconds before it.</p>
      <div class="row"><select id="experiment" aria-label="experiment" style="flex:1;max-width:none"></select></div>
      <div class="row"><label><input type="checkbox" id="only-contacts"${new Markup(this.onlyContacts ? " checked" : "")}> only laps with collisions</label></div>
      <p><b>${laps.length}</b> laps, <b>${finished}</b> finished, <b>${contacts}</b> collisions</p>
      <table><thead><tr><th>Lap</th><th class="n">Time, s</th><th>Collisions</th></tr></thead><tbody></tbody></table>`.text;
    const select = this.root.querySelector<HTMLSelectElement>("#experiment")!;
    select.append(...all.experiments.map((e, i) => new Option(`${e.label} · ${e.scenario}`, String(i), false, i === this.experiment)));
    select.onchange = () => { this.experiment = Number(select.value); this.render(); };
    const only = this.root.querySelector<HTMLInputElement>("#only-contacts")!;
    only.onchange = () => { this.onlyContacts = only.checked; this.render(); };
    const body = this.root.querySelector("tbody")!;
    for (const lap of laps) {
      if (this.onlyContacts && !lap.points.length) continue;
      const row = body.insertRow(), name = row.insertCell(), time = row.insertCell(), collisions = row.insertCell();
      const whole = document.createElement("button");
      whole.textContent = String(lap.lap);
      whole.title = "drive this lap from its start";
      whole.onclick = () => this.go(lap, -1);
      name.append(whole);
      time.textContent = lap.finished ? lap.time.toFixed(2) : "not finished";
      time.className = "n";
      lap.points.forEach(([x, y], i) => {
        const button = document.createElement("button");
        button.dataset.contact = `${lap.experiment}/${lap.lap}/${i}`;
        button.className = button.dataset.contact === this.shown ? "on" : "";
        button.textContent = `${x.toFixed(1)}, ${y.toFixed(1)} m`;
        button.onclick = () => this.go(lap, i);
        collisions.append(button, " ");
      });
    }
    this.changed();
  }
}
