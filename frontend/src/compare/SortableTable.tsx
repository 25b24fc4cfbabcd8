import { useMemo, useState } from "react";
import { Button, Group, ScrollArea, Table, TextInput, UnstyledButton } from "@mantine/core";
import { useI18n } from "../i18n/I18n";
import type { Schemas } from "../api/client";
import { compareCells, type Cell } from "./compareCells";

type Told = Schemas["ComparisonTable"];

interface Props {
  name: string;
  table: Told;
  /** Short names of results. */
  labels: ReadonlyMap<string, string>;
}

/** Rows that are drawn at a time, so that no drawing takes long. */
const STEP = 60;

export function SortableTable({ name, table, labels }: Props) {
  const { t, name: words, number } = useI18n();
  const [filter, setFilter] = useState("");
  const [sort, setSort] = useState<{ column: number; down: boolean } | null>(null);
  const [shown, setShown] = useState(STEP);
  const rows = useMemo(() => {
    const text = (cell: Cell) => (typeof cell === "string" ? (labels.get(cell) ?? words(cell)) : cell);
    const named = table.rows.map((row) => row.map(text));
    const wanted = named.filter((row) => row.some((cell) => String(cell).toLowerCase().includes(filter.toLowerCase())));
    if (!sort) return wanted;
    const sign = sort.down ? -1 : 1;
    return wanted.sort((a, b) => sign * compareCells(a[sort.column] ?? null, b[sort.column] ?? null));
  }, [table, labels, words, filter, sort]);
  const csv = [table.columns, ...rows].map((row) => row.map((cell) => cell ?? "").join(",")).join("\n");
  return (
    <>
      <Group className="no-print">
        <TextInput
          aria-label={t("filter")}
          placeholder={t("filter")}
          value={filter}
          onChange={(event) => setFilter(event.currentTarget.value)}
        />
        <Button
          component="a"
          variant="default"
          download={`${name}.csv`}
          href={`data:text/csv;charset=utf-8,${encodeURIComponent(csv)}`}
        >
          csv
        </Button>
      </Group>
      <ScrollArea.Autosize mah={460} viewportProps={{ tabIndex: 0, role: "region", "aria-label": words(name) }}>
        <Table stickyHeader striped>
          <Table.Thead>
            <Table.Tr>
              {table.columns.map((column, index) => (
                <Table.Th
                  key={column}
                  aria-sort={sort?.column === index ? (sort.down ? "descending" : "ascending") : "none"}
                >
                  <UnstyledButton
                    fw={700}
                    fz="sm"
                    onClick={() => setSort({ column: index, down: sort?.column === index && !sort.down })}
                  >
                    {words(column)} {sort?.column === index ? (sort.down ? "▼" : "▲") : ""}
                  </UnstyledButton>
                </Table.Th>
              ))}
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {rows.slice(0, shown).map((row, index) => (
              <Table.Tr key={index}>
                {row.map((cell, column) => (
                  <Table.Td key={column}>{typeof cell === "number" ? number(cell, 3) : String(cell ?? "–")}</Table.Td>
                ))}
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
        {rows.length > shown && (
          <Button variant="subtle" onClick={() => setShown(shown + STEP)}>
            {t("showMore", { count: rows.length - shown })}
          </Button>
        )}
      </ScrollArea.Autosize>
    </>
  );
}
