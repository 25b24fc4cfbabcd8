/** What the job 'inspect' found in a recording. */
import type { Schemas } from "../api/client";
import { eventsIn, type CorrectedEvent } from "./events";

export interface Found {
  frames: string;
  markers: readonly string[];
  gaps: readonly string[];
  events: string;
  eventTimes: readonly CorrectedEvent[];
  plates: string;
  parameters: Readonly<Record<string, number>>;
  warnings: readonly string[];
}

function list(text: string | undefined, separator = ", "): string[] {
  return !text || text === "none" ? [] : text.split(separator);
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
    frames: texts.get("frames") ?? "",
    markers: list(texts.get("markers")),
    gaps: list(texts.get("markers with gaps")),
    events: texts.get("events") ?? "",
    eventTimes: eventsIn(texts.get("event times")),
    plates: texts.get("force plates") ?? "",
    parameters: Object.fromEntries(parameters),
    warnings: list(texts.get("warnings"), "; "),
  };
}
