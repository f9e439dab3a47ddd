import type { Link } from "./link";
import type { Frame, Hello, Options, State } from "./protocol";

export type Command = Record<string, unknown>;

/** The facts that all parts of the page share: the newest messages, and the link that they come from. */
export const page = {
  link: undefined as unknown as Link, // set before anything is sent
  hello: undefined as Hello | undefined,
  state: undefined as State | undefined,
  options: undefined as Options | undefined,
  frame: undefined as Frame | undefined, // the one that is shown
  position: 0, // its number, in the past
  isDirty: true, // the page is to be drawn again
};

/** The recording inside this page, if there is one. */
export const recordings = document.querySelectorAll('script[type="application/x-slalom-replay"]');
export const isReplay = recordings.length > 0;

/** The program inside this page's folder that takes the place of a server, if there is one. */
export const solver = document.querySelector<HTMLMetaElement>('meta[name="solver"]')?.content;

export const send = (command: Command) => page.link.send(command);
/** Sends a command and waits until it was executed; fails with the reason why it could not be. */
export const ask = (command: Command) => page.link.ask(command);
export const redraw = () => void (page.isDirty = true);

/** A figure of a control step, by default of the frame that is shown; NaN if it is not known. */
export function scalar(name: string, scalars: Float64Array | undefined = page.frame?.scalars): number {
  return scalars?.[page.hello?.scalars.indexOf(name) ?? -1] ?? NaN;
}

/** The options that were changed, as section.option=value. */
export const changedOptions = () => page.options?.changed ?? [];
/** The time between two control steps, s. */
export const period = () => page.state?.control_period ?? page.hello?.control_period ?? 0.025;
