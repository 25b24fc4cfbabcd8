/** How far the model-optimal walk is from the measured one, beside simpler choices of weights. */
import { Table, Text, Title } from "@mantine/core";
import { useI18n } from "../i18n/I18n";
import type { Weights } from "./document";

const DEGREES = 180 / Math.PI;

export function WeightsFit({ weights }: { weights: Weights }) {
  const { t, name, number, small, told } = useI18n();
  const { fit, comparison, solver } = weights;
  const rows: [string, number | null][] = [
    [t("foundWeights"), fit.rms_rad],
    ...(comparison ? [[t("equalWeights"), comparison.equal_weights_rms_rad] as [string, number | null]] : []),
    ...Object.entries(comparison?.single_criterion_rms_rad ?? {}).map(([criterion, value]): [string, number | null] => [
      t("only", { name: name(criterion) }),
      value,
    ]),
    ...Object.entries(fit.unseen_stride_rms_rad ?? {}).map(([stride, value]): [string, number] => [
      t("unseenStride", { name: told(stride) }),
      value,
    ]),
  ];
  return (
    <>
      <Title order={2}>{t("fit")}</Title>
      <Table maw={600}>
        <Table.Tbody>
          {rows.map(([title, value]) => (
            <Table.Tr key={title}>
              <Table.Th>{title}</Table.Th>
              <Table.Td>{value === null ? "–" : `${number(DEGREES * value, 2)}°`}</Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
      <Text size="sm" c="dimmed">
        {t("certificate", {
          residual: small(solver.kkt_residual),
          iterations: solver.iterations,
          seconds: number(solver.seconds, 0),
        })}
      </Text>
    </>
  );
}
