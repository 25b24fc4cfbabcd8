/** A table of one row per result, made of the long tables of a comparison. */
import type { Schemas } from "../api/client";
import type { Cell } from "./compareCells";

type Long = Schemas["ComparisonTable"];

/** One column of numbers: a quantity of a side, or a weight. */
export interface Quantity {
  key: string;
  name: string;
  /** Empty for both sides together. */
  side: string;
  isWeight: boolean;
}

export interface Wide {
  quantities: readonly Quantity[];
  /** By result, in the order given, then by the quantity's key. */
  values: ReadonlyMap<string, ReadonlyMap<string, number>>;
}

function column(table: Long, name: string): (row: readonly Cell[]) => Cell {
  const index = table.columns.indexOf(name);
  return (row) => row[index] ?? null;
}

/** Gather rows (result, name, side, value) under their results. */
export function widen(tables: Readonly<Record<string, Long>>, results: readonly string[]): Wide {
  const quantities = new Map<string, Quantity>();
  const values = new Map(results.map((id) => [id, new Map<string, number>()]));
  const gather = (table: Long | undefined, names: { name: string; value: string }, isWeight: boolean) => {
    if (!table) return;
    const [result, name, side, value] = ["result", names.name, "side", names.value].map((each) => column(table, each));
    for (const row of table.rows) {
      const [told, quantity] = [value?.(row), String(name?.(row))];
      const at = isWeight ? "" : String(side?.(row) ?? "");
      const key = `${isWeight ? "weight " : ""}${quantity} ${at}`.trim();
      if (typeof told !== "number") continue;
      quantities.set(key, { key, name: quantity, side: at, isWeight });
      values.get(String(result?.(row)))?.set(key, told);
    }
  };
  gather(tables.quantities, { name: "quantity", value: "value" }, false);
  gather(tables.weights, { name: "criterion", value: "weight" }, true);
  return { quantities: [...quantities.values()], values };
}

/** Parts one after the other; a quantity that one of them has is one of all. */
export function join(parts: readonly Wide[]): Wide {
  const quantities = new Map(parts.flatMap((part) => part.quantities.map((each) => [each.key, each] as const)));
  return { quantities: [...quantities.values()], values: new Map(parts.flatMap((part) => [...part.values])) };
}

/** A cell of a csv file. */
export function csvCell(cell: Cell): string {
  const text = String(cell ?? "");
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
