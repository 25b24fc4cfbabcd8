/** A small table whose cells are edited in place. */
import { Button, CloseButton, NativeSelect, NumberInput, ScrollArea, Table, TextInput } from "@mantine/core";
import { useI18n } from "../i18n/I18n";

export type Row = Readonly<Record<string, string | number | null>>;

export interface Column {
  key: string;
  label: string;
  /** What may be chosen; without, the cell is typed. */
  choices?: readonly { value: string; label: string }[];
  /** Step of a number; without, the cell is a text. */
  step?: number;
  /** Decimals that are always shown. */
  digits?: number;
}

interface Props {
  label: string;
  columns: readonly Column[];
  rows: readonly Row[];
  /** A new row. */
  blank: Row;
  onChange: (rows: Row[]) => void;
}

export function RowsEditor({ label, columns, rows, blank, onChange }: Props) {
  const { t } = useI18n();
  const set = (index: number, key: string, value: string | number | null) =>
    onChange(rows.map((row, at) => (at === index ? { ...row, [key]: value } : row)));
  return (
    <>
      <ScrollArea>
        <Table aria-label={label} verticalSpacing={4}>
          <Table.Thead>
            <Table.Tr>
              {columns.map((column) => (
                <Table.Th key={column.key}>{column.label}</Table.Th>
              ))}
              <Table.Th w={40}>
                <span className="unseen">{t("delete")}</span>
              </Table.Th>
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {rows.map((row, index) => (
              <Table.Tr key={index}>
                {columns.map((column) => (
                  <Table.Td key={column.key}>
                    <Cell
                      column={column}
                      label={`${column.label} ${index + 1}`}
                      value={row[column.key] ?? null}
                      onChange={(value) => set(index, column.key, value)}
                    />
                  </Table.Td>
                ))}
                <Table.Td>
                  <CloseButton
                    aria-label={`${t("delete")} ${index + 1}`}
                    onClick={() => onChange(rows.filter((_, at) => at !== index))}
                  />
                </Table.Td>
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      </ScrollArea>
      <Button
        size="xs"
        variant="default"
        mt={4}
        style={{ alignSelf: "start" }}
        onClick={() => onChange([...rows, blank])}
      >
        {t("addRow", { what: label })}
      </Button>
    </>
  );
}

interface CellProps {
  column: Column;
  label: string;
  value: string | number | null;
  onChange: (value: string | number | null) => void;
}

function Cell({ column, label, value, onChange }: CellProps) {
  if (column.choices) {
    return (
      <NativeSelect
        size="xs"
        aria-label={label}
        value={value ?? ""}
        data={[...column.choices]}
        onChange={(event) => onChange(event.currentTarget.value)}
      />
    );
  }
  if (column.step !== undefined) {
    return (
      <NumberInput
        size="xs"
        aria-label={label}
        value={value ?? ""}
        step={column.step}
        {...(column.digits === undefined ? {} : { decimalScale: column.digits, fixedDecimalScale: true })}
        onChange={(number) => onChange(number === "" ? null : Number(number))}
      />
    );
  }
  return (
    <TextInput
      size="xs"
      aria-label={label}
      value={value ?? ""}
      onChange={(event) => onChange(event.currentTarget.value)}
    />
  );
}
