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

/** Lines of a panel as rows of text, the header first. */
export function rowsOf(data: PanelData): string[][] {
  const header = ["percent", ...data.lines.flatMap(({ label, sd }) => (sd ? [`${label} mean`, `${label} sd`] : [label]))];
  const rows = Array.from({ length: 101 }, (_, percent) => [
    String(percent),
    ...data.lines.flatMap(({ mean, sd }) => (sd ? [mean[percent], sd[percent]] : [mean[percent]])).map((value) =>
      value == null ? "" : value.toFixed(4),
    ),
  ]);
  return [header, ...rows];
}

export function ValuesModal({ layout, data, onClose }: Props) {
  const { t, name } = useI18n();
  if (!layout || !data) return null;
  const [header = [], ...rows] = rowsOf(data);
  const csv = [header, ...rows].map((row) => row.join(",")).join("\n");
  return (
    <Modal
      opened
      size="lg"
      onClose={onClose}
      title={`${name(layout.name)} [${layout.unit}]`}
      closeButtonProps={{ "aria-label": t("close") }}
    >
      <Button
        component="a"
        mb="sm"
        variant="default"
        download={`${layout.name}.csv`}
        href={`data:text/csv;charset=utf-8,${encodeURIComponent(csv)}`}
      >
        csv
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
                  <Table.Td key={index}>{cell}</Table.Td>
                ))}
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      </ScrollArea>
    </Modal>
  );
}
