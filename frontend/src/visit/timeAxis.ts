/** Where events lie on a time line, and where they go when they are dragged or moved by keys. */
import type { CorrectedEvent } from "./events";
import type { Timing } from "./inspection";

export interface TimeAxis {
  /** Time of the last frame [s]. */
  end: number;
  /** Seconds from frame to frame. */
  frame: number;
}

/** Where the frame rate is unknown, events move by this [s]. */
const FINE = 0.01;
const MOST_TICKS = 12;
/** Frames that a key moves an event by; Home and End go to the ends. */
const STEPS: Readonly<Record<string, number>> = {
  ArrowLeft: -1,
  ArrowDown: -1,
  ArrowRight: 1,
  ArrowUp: 1,
  PageDown: -10,
  PageUp: 10,
  Home: -Infinity,
  End: Infinity,
};

/** From the first frame to the last; without a frame rate to the first full second behind all events. */
export function axisOf(timing: Timing | null, events: readonly CorrectedEvent[]): TimeAxis {
  if (timing && timing.frames > 1) return { end: (timing.frames - 1) / timing.rate, frame: 1 / timing.rate };
  return { end: Math.floor(Math.max(0, ...events.map(({ time_s }) => time_s))) + 1, frame: FINE };
}

/** The time of the nearest frame of the recording. */
export function snapped(time: number, { end, frame }: TimeAxis): number {
  const last = Math.floor(end / frame + 1e-6);
  const nearest = Math.min(Math.max(Math.round(time / frame), 0), last);
  return Number((nearest * frame).toFixed(4));
}

/** Where a key moves an event; null for keys that move nothing. */
export function movedByKey(time: number, key: string, axis: TimeAxis): number | null {
  const step = STEPS[key];
  return step === undefined ? null : snapped(time + step * axis.frame, axis);
}

/** The events, one of them at another time. */
export function withTime(events: readonly CorrectedEvent[], index: number, time_s: number): CorrectedEvent[] {
  return events.map((each, at) => (at === index ? { ...each, time_s } : each));
}

/** Round times on the axis, not too many of them. */
export function ticksOf({ end }: TimeAxis): number[] {
  const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60].find((each) => end / each <= MOST_TICKS) ?? 300;
  return Array.from({ length: Math.floor(end / step + 1e-6) + 1 }, (_, index) => Number((index * step).toFixed(1)));
}

/** When a foot is on the floor, as far as its events tell: from each strike to the next foot off. */
export function stancesOf(
  events: readonly CorrectedEvent[],
  side: CorrectedEvent["side"],
  { end }: TimeAxis,
): [number, number][] {
  const own = events.filter((each) => each.side === side).sort((a, b) => a.time_s - b.time_s);
  const begun: [number, number][] = own[0]?.kind === "foot_off" ? [[0, own[0].time_s]] : [];
  const others = own.flatMap(({ kind, time_s }, index): [number, number][] =>
    kind === "foot_strike" ? [[time_s, own[index + 1]?.time_s ?? end]] : [],
  );
  return [...begun, ...others];
}
