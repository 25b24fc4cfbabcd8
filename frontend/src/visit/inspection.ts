/** What the job 'inspect' found in a recording. */
import type { Schemas } from "../api/client";
import { countsIn, eventsIn, type CorrectedEvent, type EventCount } from "./events";

/** When the frames of a recording are, from time zero on. */
export interface Timing {
  frames: number;
  /** Frames per second. */
  rate: number;
}

export interface Plate {
  number: number;
  /** Largest force [N]. */
  newton: number;
  /** Samples per second. */
  rate: number;
}

export interface Found {
  /** null where the row is worded in another way. */
  timing: Timing | null;
  markers: readonly string[];
  gaps: readonly string[];
  /** How many of each kind and side. */
  events: readonly EventCount[];
  eventTimes: readonly CorrectedEvent[];
  plates: readonly Plate[];
  parameters: Readonly<Record<string, number>>;
  warnings: readonly string[];
}

function list(text: string | undefined, separator = ", "): string[] {
  return !text || text === "none" ? [] : text.split(separator);
}

const FRAMES = /^(\d+) at ([\d.]+) Hz/;
const PLATE = /^(\d+): up to (\d+) N at ([\d.]+) Hz$/;

function timingIn(text: string | undefined): Timing | null {
  const [, frames, rate] = FRAMES.exec(text ?? "") ?? [];
  return frames && rate ? { frames: Number(frames), rate: Number(rate) } : null;
}

function platesIn(text: string | undefined): Plate[] {
  return list(text).flatMap((each) => {
    const [, number, newton, rate] = PLATE.exec(each) ?? [];
    return number && newton && rate ? [{ number: Number(number), newton: Number(newton), rate: Number(rate) }] : [];
  });
}

/** Title and text of the inspection's rows as fields. */
export function foundIn(recording: Pick<Schemas["Recording"], "inspection">): Found | null {
  const rows = recording.inspection?.rows as [string, string][] | undefined;
  if (!rows) return null;
  const texts = new Map(rows);
  const parameters = list(texts.get("body parameters")).map((each): [string, number] => {
    const space = each.lastIndexOf(" ");
    return [each.slice(0, space), Number(each.slice(space + 1))];
  });
  return {
    timing: timingIn(texts.get("frames")),
    markers: list(texts.get("markers")),
    gaps: list(texts.get("markers with gaps")),
    events: countsIn(texts.get("events")),
    eventTimes: eventsIn(texts.get("event times")),
    plates: platesIn(texts.get("force plates")),
    parameters: Object.fromEntries(parameters),
    warnings: list(texts.get("warnings"), "; "),
  };
}
