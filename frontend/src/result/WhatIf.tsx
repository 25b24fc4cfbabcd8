/** The optimal walk of a changed body or task, as a job. */
import { useState } from "react";
import { Button, Paper, SimpleGrid, Slider, Text, Title } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { client, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { JobCard } from "../jobs/JobCard";
import { changesOf } from "./changes";

/** Quantities of `gaitlab predict --set`, each changed by some per cent. */
const QUANTITIES = [
  { name: "speed", low: -20, high: 20 },
  { name: "mass", low: -20, high: 20 },
  { name: "left_ankle_plantarflexor_limit", low: -50, high: 0 },
  { name: "right_ankle_plantarflexor_limit", low: -50, high: 0 },
] as const;

export function WhatIf({ resultId }: { resultId: string }) {
  const { t, name } = useI18n();
  const [values, setValues] = useState<Readonly<Record<string, number>>>({});
  const predict = useMutation({
    mutationFn: () =>
      unwrap(
        client.POST("/api/v1/analyses", {
          body: { kind: "predict", result_id: resultId, changes: changesOf(values) },
        }),
      ),
  });
  return (
    <Paper withBorder p="md" className="no-print">
      <Title order={2}>{t("whatIf")}</Title>
      <Text c="dimmed">{t("whatIfHint")}</Text>
      <SimpleGrid cols={{ base: 1, md: 2 }} my="md" spacing="xl">
        {QUANTITIES.map((each) => (
          <div key={each.name}>
            <Text size="sm">
              {name(each.name)}: {values[each.name] ?? 0} %
            </Text>
            <Slider
              min={each.low}
              max={each.high}
              step={5}
              value={values[each.name] ?? 0}
              thumbLabel={name(each.name)}
              label={(value) => `${value} %`}
              onChange={(value) => setValues({ ...values, [each.name]: value })}
            />
          </div>
        ))}
      </SimpleGrid>
      <Button disabled={changesOf(values).length === 0} loading={predict.isPending} onClick={() => predict.mutate()}>
        {t("predict")}
      </Button>
      <ErrorNote error={predict.error} />
      {predict.data && <JobCard job={predict.data} />}
    </Paper>
  );
}
