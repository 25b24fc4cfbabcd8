/** The numbers behind one panel, and the same as csv. */
import { Button, Modal, ScrollArea, Table } from "@mantine/core";
import { useI18n } from "../i18n/I18n";
import type { PanelData } from "./CyclePanel";
import type { PanelLayout } from "./panels";

interface Props {
  layout: PanelLayout | null;
  data: PanelData | null;
  onClose: () => void;
}

type Row = (number | null)[];

/** Per cent of the cycle, then each line's mean and, where it has one, standard deviation. */
function rowsOf(data: PanelData): Row[] {
  return Array.from({ length: 101 }, (_, percent) => [
    percent,
    ...data.lines.flatMap(({ mean, sd }) => [mean, ...(sd ? [sd] : [])].map((values) => values[percent] ?? null)),
  ]);
}

/** The same for programs: English titles and decimal points whatever the page's language. */
function csvOf(data: PanelData, rows: readonly Row[]): string {
  const header = data.lines.flatMap(({ side, sd }, index) => {
    const cycle = data.lines.slice(0, index + 1).filter((each) => each.side === side).length;
    return sd ? [`${side} mean`, `${side} sd`] : [`${side} ${cycle}`];
  });
  const lines = rows.map(([percent, ...values]) => [percent, ...values.map((value) => value?.toFixed(4) ?? "")]);
  return [["percent", ...header], ...lines].map((line) => line.join(",")).join("\n");
}

export function ValuesModal({ layout, data, onClose }: Props) {
  const { t, name, number, unit } = useI18n();
  if (!layout || !data) return null;
  const rows = rowsOf(data);
  const header = [
    t("percentOfCycle"),
    ...data.lines.flatMap(({ label: line, sd }) =>
      sd ? [t("meanOf", { name: line }), t("sdOf", { name: line })] : [line],
    ),
  ];
  return (
    <Modal
      opened
      size="lg"
      onClose={onClose}
      title={`${name(layout.name)} [${unit(layout.unit)}]`}
      closeButtonProps={{ "aria-label": t("close") }}
    >
      <Button
        component="a"
        mb="sm"
        variant="default"
        download={`${layout.name}.csv`}
        href={`data:text/csv;charset=utf-8,${encodeURIComponent(csvOf(data, rows))}`}
      >
        {t("saveCsv")}
      </Button>
      <ScrollArea h={420} viewportProps={{ tabIndex: 0, "aria-label": name(layout.name), role: "region" }}>
        <Table stickyHeader>
          <Table.Thead>
            <Table.Tr>
              {header.map((title, index) => (
                <Table.Th key={index}>{title}</Table.Th>
              ))}
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {rows.map((row) => (
              <Table.Tr key={row[0]}>
                {row.map((cell, index) => (
                  <Table.Td key={index}>{number(cell, index === 0 ? 0 : 2)}</Table.Td>
                ))}
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      </ScrollArea>
    </Modal>
  );
}
