/** HTML that is ready to be shown. */
export class Markup { constructor(readonly text: string) {} }

const entities: Record<string, string> = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#39;" };

function escaped(value: unknown): string {
  if (value instanceof Markup) return value.text;
  if (Array.isArray(value)) return value.map(escaped).join("");
  return String(value).replace(/[&<>"']/g, (character) => entities[character]);
}

/** HTML from a template. Values are escaped, since names come from files and from the server; markup and lists of it are not. */
export function html(parts: TemplateStringsArray, ...values: unknown[]): Markup {
  return new Markup(parts.map((part, i) => part + (i < values.length ? escaped(values[i]) : "")).join(""));
}
