/** Events of a recording as the file has them, and as somebody corrected them. */
import type { Schemas } from "../api/client";

export type CorrectedEvent = Schemas["CorrectedEvent"];
/** All events of a recording, by the recording's id, where they were corrected. */
export type Corrections = Readonly<Record<string, readonly CorrectedEvent[]>>;

const WRITTEN = /^(left|right) (foot strike|foot off) ([\d.]+)$/;

/** Events out of the inspection's row, such as "left foot strike 0.5120, right foot off 0.6300". */
export function eventsIn(text: string | undefined): CorrectedEvent[] {
  return (text ?? "").split(", ").flatMap((each) => {
    const [, side, kind, time] = WRITTEN.exec(each) ?? [];
    if (!side || !kind) return [];
    return [{ side, kind: kind.replace(" ", "_"), time_s: Number(time) } as CorrectedEvent];
  });
}

export interface EventCount {
  count: number;
  side: CorrectedEvent["side"];
  kind: CorrectedEvent["kind"];
}

const COUNTED = /^(\d+) (left|right) (foot strike|foot off)$/;

/** Numbers of events out of the inspection's row, such as "3 left foot off, 2 right foot strike". */
export function countsIn(text: string | undefined): EventCount[] {
  return (text ?? "").split(", ").flatMap((each) => {
    const [, count, side, kind] = COUNTED.exec(each) ?? [];
    return count && side && kind ? [{ count: Number(count), side, kind: kind.replace(" ", "_") } as EventCount] : [];
  });
}

/** Corrections under the names of their trials, as an analysis takes them. */
export function byTrial(
  corrections: Corrections,
  recordings: readonly Pick<Schemas["Recording"], "id" | "name">[],
): Record<string, CorrectedEvent[]> {
  return Object.fromEntries(
    recordings.flatMap(({ id, name }) => {
      const events = corrections[id];
      return events ? [[name.replace(/\.[^.]*$/, ""), [...events].sort((a, b) => a.time_s - b.time_s)]] : [];
    }),
  );
}
