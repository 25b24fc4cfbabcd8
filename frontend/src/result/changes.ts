/** What a prediction is asked to change. */

/** Changes in the form of the command line; quantities at zero are left alone. */
export function changesOf(values: Readonly<Record<string, number>>): string[] {
  return Object.entries(values)
    .filter(([, value]) => value !== 0)
    .map(([name, value]) => `${name}=${value > 0 ? "+" : ""}${value}%`);
}

/** Weights [%] as assignments of the command line; those within half a per cent of the identified ones are left alone. */
export function weightChangesOf(
  wanted: Readonly<Record<string, number>>,
  identified: readonly { name: string; weight: number }[],
): string[] {
  return identified
    .filter(({ name, weight }) => Math.abs((wanted[name] ?? 100 * weight) - 100 * weight) >= 0.5)
    .map(({ name }) => `${name}_weight=${(wanted[name] ?? 0) / 100}`);
}
