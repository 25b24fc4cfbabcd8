/** Between a time in a recording and a percentage of the gait cycle. */
import type { Side, Stride } from "./document";

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
