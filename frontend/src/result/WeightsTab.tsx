import { Alert, List, Stack, Table, Text, Title } from "@mantine/core";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import type { ResultDocument, Weights } from "./document";
import { OptimalCurves } from "./OptimalCurves";
import { ShareChart } from "./ShareChart";
import { useWalk } from "./walk";
import { WeightBars } from "./WeightBars";
import { WeightsFit } from "./WeightsFit";
import { Identifiability } from "./Identifiability";
import { WhatIf } from "./WhatIf";

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
      <WeightBars weights={weights} reference={document.scores?.reference ?? null} />
      <Identifiability weights={weights} />
      <OverTheCycle resultId={resultId} document={document} />
      {weights.pooled && <Pooled pooled={weights.pooled} />}
      <WeightsFit weights={weights} />
      <List size="sm">
        {weights.notes?.map((note) => (
          <List.Item key={note}>{note}</List.Item>
        ))}
      </List>
      {!document.prediction && <WhatIf resultId={resultId} criteria={weights.criteria} />}
    </Stack>
  );
}

/** What needs the arrays of the walk, which are read beside the document. */
function OverTheCycle({ resultId, document }: { resultId: string; document: ResultDocument }) {
  const { t } = useI18n();
  const walk = useWalk(resultId, document);
  if (!walk.data) return <ErrorNote error={walk.error} />;
  return (
    <>
      {walk.data.shares && (
        <>
          <Title order={2}>{t("shareOverCycle")}</Title>
          <Text size="sm" c="dimmed">
            {t("shareExplained")}
          </Text>
          <ShareChart shares={walk.data.shares} />
        </>
      )}
      <Title order={2}>{t("measuredAgainstOptimal")}</Title>
      <OptimalCurves walk={walk.data} />
    </>
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
