/** Which rows of a table are wanted: words, and conditions on numbers such as "gps_overall>8". */
import type { Cell } from "./compareCells";

const CONDITION = /^(.+?)(<=|>=|<|>)(-?[\d.]+)$/;

function holds(value: Cell, sign: string, bound: number): boolean {
  if (typeof value !== "number") return false;
  if (sign === "<") return value < bound;
  if (sign === ">") return value > bound;
  return sign === "<=" ? value <= bound : value >= bound;
}

/** Whether a row has every word of the filter and meets every condition; an unknown column is met by none. */
export function meets(row: readonly Cell[], columns: readonly string[], filter: string): boolean {
  return filter
    .toLowerCase()
    .split(/\s+/)
    .filter(Boolean)
    .every((word) => {
      const [, name, sign, bound] = CONDITION.exec(word) ?? [];
      if (!name || !sign) return row.some((cell) => typeof cell === "string" && cell.toLowerCase().includes(word));
      return columns.some((column, index) => column.includes(name) && holds(row[index] ?? null, sign, Number(bound)));
    });
}
