/** Rows of cells: sorted by any column, filtered by words and by numbers, saved as csv. */
import { memo, useDeferredValue, useMemo, useState, useTransition } from "react";
import { Button, Group, ScrollArea, Table, TextInput, UnstyledButton } from "@mantine/core";
import { useI18n } from "../i18n/I18n";
import { compareCells, type Cell } from "./compareCells";
import { meets } from "./filters";
import { csvCell } from "./wide";

export interface Column {
  key: string;
  label: string;
  /** Decimals of its numbers. */
  digits?: number;
}

interface Props {
  /** Of the csv file, and for those who hear the page. */
  name: string;
  columns: readonly Column[];
  rows: readonly (readonly Cell[])[];
  /** Of the columns, in order; all may be sorted out by the filter. */
  shown: readonly number[];
}

/** Rows that are drawn at a time, so that no drawing takes long. */
const STEP = 25;

export function SortableTable({ name, columns, rows, shown }: Props) {
  const { t } = useI18n();
  const [, startTransition] = useTransition();
  const [typed, setTyped] = useState("");
  const filter = useDeferredValue(typed);
  const [sort, setSort] = useState<{ column: number; down: boolean } | null>(null);
  const [length, setLength] = useState(STEP);
  const keys = useMemo(() => columns.map((each) => each.key), [columns]);
  const sorted = useMemo(() => {
    const wanted = rows.filter((row) => meets(row, keys, filter));
    if (!sort) return wanted;
    const sign = sort.down ? -1 : 1;
    return wanted.sort((a, b) => compareCells(a[sort.column] ?? null, b[sort.column] ?? null, sign));
  }, [rows, keys, filter, sort]);
  const save = () => {
    const lines = [columns.map((each) => each.label), ...sorted].map((row) =>
      shown.map((index) => csvCell(row[index] ?? null)).join(","),
    );
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([lines.join("\n")], { type: "text/csv" }));
    link.download = `${name}.csv`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  };
  return (
    <>
      <Group className="no-print" align="end">
        <TextInput
          label={t("filter")}
          description={t("filterHint")}
          w={360}
          value={typed}
          onChange={(event) => setTyped(event.currentTarget.value)}
        />
        <Button variant="default" onClick={save}>
          {t("saveCsv")}
        </Button>
      </Group>
      <ScrollArea.Autosize mah={520} viewportProps={{ tabIndex: 0, role: "region", "aria-label": name }}>
        <Table stickyHeader className="numbers first-column">
          <Table.Thead>
            <Table.Tr>
              {shown.map((index) => (
                <Table.Th
                  key={columns[index]?.key}
                  aria-sort={sort?.column === index ? (sort.down ? "descending" : "ascending") : "none"}
                >
                  <UnstyledButton
                    fw={700}
                    fz="sm"
                    onClick={() =>
                      startTransition(() => setSort({ column: index, down: sort?.column === index && !sort.down }))
                    }
                  >
                    {columns[index]?.label} {sort?.column === index ? (sort.down ? "▼" : "▲") : ""}
                  </UnstyledButton>
                </Table.Th>
              ))}
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {sorted.slice(0, length).map((row) => (
              <Line key={String(row[0])} row={row} shown={shown} columns={columns} />
            ))}
          </Table.Tbody>
        </Table>
        {sorted.length > length && (
          <Button variant="subtle" onClick={() => startTransition(() => setLength(length + STEP))}>
            {t("showMore", { count: sorted.length - length })}
          </Button>
        )}
      </ScrollArea.Autosize>
    </>
  );
}

/** Plain cells: a thousand components of a library would take longer than their text. */
const Line = memo(function Line({ row, shown, columns }: Pick<Props, "shown" | "columns"> & { row: readonly Cell[] }) {
  const { number } = useI18n();
  return (
    <tr>
      {shown.map((index) => {
        const cell = row[index] ?? null;
        return <td key={index}>{typeof cell === "number" ? number(cell, columns[index]?.digits ?? 2) : String(cell ?? "–")}</td>;
      })}
    </tr>
  );
});
