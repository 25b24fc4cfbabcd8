import { Alert, Group, List, Paper, Stack, Table, Text, Title } from "@mantine/core";
import { CRITERIA } from "../app/colours";
import { useI18n } from "../i18n/I18n";
import type { Criterion, Reference, ResultDocument, Weights } from "./document";
import { WhatIf } from "./WhatIf";

const DEGREES = 180 / Math.PI;

export function WeightsTab({ resultId, document }: { resultId: string; document: ResultDocument }) {
  const { t } = useI18n();
  const { weights } = document;
  if (!weights) return <Text>{t("noWeights")}</Text>;
  return (
    <Stack maw={1100}>
      {weights.solver.status !== "solved" && (
        <Alert color="orange" title={t("notConverged")}>
          {weights.solver.message}
        </Alert>
      )}
      <Text>{t("weightsExplained")}</Text>
      <Bars weights={weights} reference={document.scores?.reference ?? null} />
      <Identifiability criteria={weights.criteria} />
      {weights.pooled && <Pooled pooled={weights.pooled} />}
      <Fit weights={weights} />
      <List size="sm">
        {weights.notes?.map((note) => (
          <List.Item key={note}>{note}</List.Item>
        ))}
      </List>
      {!document.prediction && <WhatIf resultId={resultId} />}
    </Stack>
  );
}

function Bars({ weights, reference }: { weights: Weights; reference: Reference | null }) {
  const { name, number, t } = useI18n();
  return (
    <Paper withBorder p="md">
      <Stack gap="xs" data-testid="weights">
        {weights.criteria.map((each, index) => {
          const norm = reference?.weights?.[each.name];
          return (
            <Group key={each.name} wrap="nowrap" align="center">
              <Text w={220}>{name(each.name)}</Text>
              <Bar criterion={each} colour={CRITERIA[index % CRITERIA.length] ?? "gray"} norm={norm} />
              <Text w={150} ta="right">
                {number(100 * each.weight)} {each.sd !== null && `± ${number(100 * each.sd)} `}%
              </Text>
              <Text w={150} size="sm" c="dimmed">
                {each.cost_share != null && t("costShare", { value: number(100 * each.cost_share, 0) })}
              </Text>
            </Group>
          );
        })}
      </Stack>
    </Paper>
  );
}

interface BarProps {
  criterion: Criterion;
  colour: string;
  norm: { mean: number; sd: number } | undefined;
}

function clip(value: number): number {
  return Math.min(Math.max(100 * value, 0), 100);
}

/** Weight as a bar, its uncertainty as a whisker, the reference interval grey behind. */
function Bar({ criterion, colour, norm }: BarProps) {
  const { weight, sd } = criterion;
  return (
    <svg viewBox="0 0 100 10" preserveAspectRatio="none" style={{ flex: 1, height: 26 }} aria-hidden>
      <rect width="100" height="10" fill="var(--mantine-color-default-border)" opacity={0.35} />
      {norm && (
        <rect
          x={clip(norm.mean - norm.sd)}
          width={clip(norm.mean + norm.sd) - clip(norm.mean - norm.sd)}
          height="10"
          fill="gray"
          opacity={0.5}
        />
      )}
      <rect y="2" width={clip(weight)} height="6" fill={colour} opacity={criterion.identifiable ? 1 : 0.35} />
      {sd !== null && (
        <rect x={clip(weight - sd)} y="4.6" width={clip(weight + sd) - clip(weight - sd)} height="0.8" fill="var(--mantine-color-text)" />
      )}
    </svg>
  );
}

function Identifiability({ criteria }: { criteria: readonly Criterion[] }) {
  const { t, name } = useI18n();
  return (
    <List size="sm">
      {criteria.map((each) => (
        <List.Item key={each.name}>
          <b>{name(each.name)}</b>: {t(each.identifiable ? "known" : each.at_bound ? "atBound" : "unknown")}
        </List.Item>
      ))}
    </List>
  );
}

function Pooled({ pooled }: { pooled: NonNullable<Weights["pooled"]> }) {
  const { t, name, number } = useI18n();
  return (
    <>
      <Title order={2}>{t("pooledStrides", { count: pooled.n_strides })}</Title>
      <Table maw={600}>
        <Table.Tbody>
          {Object.entries(pooled.weights).map(([criterion, weight]) => {
            const sd = pooled.between_stride_sd[criterion];
            return (
              <Table.Tr key={criterion}>
                <Table.Th>{name(criterion)}</Table.Th>
                <Table.Td>
                  {number(100 * weight)} {sd != null && `± ${number(100 * sd)}`} %
                </Table.Td>
              </Table.Tr>
            );
          })}
        </Table.Tbody>
      </Table>
    </>
  );
}

function Fit({ weights }: { weights: Weights }) {
  const { t, name, number } = useI18n();
  const { fit, comparison, solver } = weights;
  const rows: [string, number | null][] = [
    [t("foundWeights"), fit.rms_rad],
    ...(comparison ? [[t("equalWeights"), comparison.equal_weights_rms_rad] as [string, number | null]] : []),
    ...Object.entries(comparison?.single_criterion_rms_rad ?? {}).map(([criterion, value]): [string, number | null] => [
      t("only", { name: name(criterion) }),
      value,
    ]),
    ...Object.entries(fit.unseen_stride_rms_rad ?? {}).map(([stride, value]): [string, number] => [
      t("unseenStride", { name: stride }),
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
          residual: solver.kkt_residual?.toExponential(1) ?? "–",
          iterations: solver.iterations,
          seconds: number(solver.seconds, 0),
        })}
      </Text>
    </>
  );
}
