/** Order of cells of a comparison. */
import type { Schemas } from "../api/client";

export type Cell = Schemas["ComparisonTable"]["rows"][number][number];

const COLLATOR = new Intl.Collator();

/** Before (negative) or after; `sign` turns the order, but unknown cells come last either way. */
export function compareCells(a: Cell, b: Cell, sign = 1): number {
  if (a === null || b === null) return Number(a === null) - Number(b === null);
  if (typeof a === "number" && typeof b === "number") return sign * (a - b);
  return sign * COLLATOR.compare(String(a), String(b));
}
