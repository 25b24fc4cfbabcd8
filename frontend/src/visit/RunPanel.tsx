import { useState } from "react";
import { Button, Group, Paper, Switch, Text, Title } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { client, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { useSubject } from "./BodyParameters";
import { byTrial, type Corrections } from "./events";

interface Props {
  visitId: string;
  recordings: readonly Schemas["Recording"][];
  corrections: Corrections;
}

export function RunPanel({ visitId, recordings, corrections }: Props) {
  const { t } = useI18n();
  const queries = useQueryClient();
  const subject = useSubject(visitId);
  const [weights, setWeights] = useState(true);
  const [redetect, setRedetect] = useState(false);
  const walks = recordings.filter((each) => each.kind === "walk");
  const run = useMutation({
    mutationFn: () =>
      unwrap(
        client.POST("/api/v1/analyses", {
          body: {
            kind: "analyse",
            session_id: visitId,
            subject_id: subject.data?.id ?? null,
            settings: { weights, redetect_events: redetect, events: byTrial(corrections, walks) },
          },
        }),
      ),
    onSuccess: () => queries.invalidateQueries({ queryKey: ["jobs"] }),
  });
  return (
    <Paper withBorder p="md">
      <Title order={2}>{t("analyse")}</Title>
      <Text c="dimmed">{t(walks.length ? "willUse" : "noWalk", { names: walks.map((each) => each.name).join(", ") })}</Text>
      <Group mt="sm" justify="space-between">
        <Group>
          <Switch
            label={t("computeWeights")}
            checked={weights}
            onChange={(event) => setWeights(event.currentTarget.checked)}
          />
          <Switch
            label={t("redetectEvents")}
            checked={redetect}
            onChange={(event) => setRedetect(event.currentTarget.checked)}
          />
        </Group>
        <Button disabled={walks.length === 0} loading={run.isPending} onClick={() => run.mutate()}>
          {t("run")}
        </Button>
      </Group>
      <ErrorNote error={run.error} />
    </Paper>
  );
}
