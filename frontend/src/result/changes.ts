/** What a prediction is asked to change. */

/** Changes in the form of the command line; quantities at zero are left alone. */
export function changesOf(values: Readonly<Record<string, number>>): string[] {
  return Object.entries(values)
    .filter(([, value]) => value !== 0)
    .map(([name, value]) => `${name}=${value > 0 ? "+" : ""}${value}%`);
}
