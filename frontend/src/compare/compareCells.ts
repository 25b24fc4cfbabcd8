/** Order of cells of a comparison; unknown ones last. */
import type { Schemas } from "../api/client";

export type Cell = Schemas["ComparisonTable"]["rows"][number][number];

export function compareCells(a: Cell, b: Cell): number {
  if (a === null || b === null) return Number(a === null) - Number(b === null);
  if (typeof a === "number" && typeof b === "number") return a - b;
  return String(a).localeCompare(String(b));
}
