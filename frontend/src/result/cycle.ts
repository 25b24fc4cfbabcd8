/** Between a time in a recording and a percentage of the gait cycle. */
import { SIDES, type ResultDocument, type Side, type Stride } from "./document";

/** The stride that stands for a trial: the representative one, or the longest-known first one. */
export function strideOf(strides: readonly Stride[], trial: string, side: Side): Stride | undefined {
  const own = strides.filter((each) => each.trial === trial && each.side === side);
  return own.find((each) => each.representative) ?? own[0];
}

/** Seconds of a percentage of a stride. */
export function timeAt(stride: Stride, percent: number): number {
  return stride.start_s + (percent / 100) * (stride.end_s - stride.start_s);
}

/** Percentage of the side's stride in which a time falls; null outside of all. */
export function percentAt(strides: readonly Stride[], trial: string, side: Side, time: number): number | null {
  const within = strides.find(
    (each) => each.trial === trial && each.side === side && time >= each.start_s && time <= each.end_s,
  );
  return within ? (100 * (time - within.start_s)) / (within.end_s - within.start_s) : null;
}

/** The strides of a result; where it lists none, from each foot strike to the same foot's next one. */
export function stridesIn(document: Pick<ResultDocument, "strides" | "events">): Stride[] {
  if (document.strides) return document.strides.strides;
  const strikes = document.events.filter((event) => event.kind === "foot_strike");
  const trials = [...new Set(strikes.map((event) => event.trial))];
  return trials.flatMap((trial) =>
    SIDES.flatMap((side) => {
      const times = strikes.filter((each) => each.trial === trial && each.side === side).map((each) => each.time_s);
      times.sort((a, b) => a - b);
      return times.slice(1).map((end, index) => ({ trial, side, start_s: times[index] ?? end, end_s: end }));
    }),
  );
}

/** Name of a trial of the 3D view in the result: a single recording has no folder, hence no name, of its own. */
export function trialIn(strides: readonly Stride[], shown: string): string {
  const known = new Set(strides.map((stride) => stride.trial));
  const [first = shown] = known;
  return known.has(shown) ? shown : first;
}
