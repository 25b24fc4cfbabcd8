/** Tables of curves over time, as written beside a result. */
import type { Stride } from "./document";

export interface Table {
  time: number[];
  columns: Map<string, (number | null)[]>;
}

/** A table with a header line; empty cells are unknown. */
export function parseTable(text: string): Table {
  const [header = "", ...lines] = text.trim().split(/\r?\n/);
  const rows = lines.map((line) => line.split(",").map((cell) => (cell === "" ? null : Number(cell))));
  const columns = new Map(header.split(",").map((name, index) => [name, rows.map((row) => row[index] ?? null)]));
  return { time: (columns.get("time") ?? []).map(Number), columns };
}

/** 101 samples of a column over a stride, linear between frames. */
export function resample(table: Table, column: string, stride: Pick<Stride, "start_s" | "end_s">): (number | null)[] {
  const values = table.columns.get(column) ?? [];
  const { time } = table;
  let after = 1;
  return Array.from({ length: 101 }, (_, percent) => {
    const moment = stride.start_s + (percent / 100) * (stride.end_s - stride.start_s);
    while (after < time.length - 1 && (time[after] ?? 0) < moment) after += 1;
    const [t0, t1] = [time[after - 1], time[after]];
    const [y0, y1] = [values[after - 1], values[after]];
    if (t0 == null || t1 == null || y0 == null || y1 == null) return null;
    return y0 + ((y1 - y0) * (moment - t0)) / (t1 - t0);
  });
}
