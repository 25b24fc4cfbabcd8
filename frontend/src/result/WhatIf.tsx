/** The optimal walk of a changed body, task or weights, as a job. */
import { useState } from "react";
import { Anchor, Button, Group, NativeSelect, Paper, SimpleGrid, Slider, Text, Title } from "@mantine/core";
import { useMutation, useQuery } from "@tanstack/react-query";
import { Link } from "wouter";
import { client, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { JobCard } from "../jobs/JobCard";
import type { Job } from "../jobs/progress";
import { isOver, LOOK_AGAIN_MS } from "../jobs/useJob";
import { changesOf, weightChangesOf } from "./changes";
import type { Criterion } from "./document";

/** Quantities that are always offered, each changed by some per cent; others can be added. */
const OFFERED = ["speed", "mass", "left_ankle_plantarflexor_limit", "right_ankle_plantarflexor_limit"];
const LARGEST = 50;

/** How far a slider goes: strength is only taken away, as nobody knows how much more there would be. */
function rangeOf(quantity: string): readonly [number, number] {
  return quantity.endsWith("_limit") ? [-LARGEST, 0] : [-20, 20];
}

export function WhatIf({ resultId, criteria }: { resultId: string; criteria: readonly Criterion[] }) {
  const { t } = useI18n();
  const [values, setValues] = useState<Readonly<Record<string, number>>>({});
  const [weights, setWeights] = useState<Readonly<Record<string, number>>>({});
  const [added, setAdded] = useState<readonly string[]>([]);
  const changes = [...changesOf(values), ...weightChangesOf(weights, criteria)];
  const predict = useMutation({
    mutationFn: () =>
      unwrap(
        client.POST("/api/v1/analyses", {
          body: { kind: "predict", result_id: resultId, changes },
        }),
      ),
  });
  const shown = [...OFFERED, ...added];
  return (
    <Paper withBorder p="md" className="no-print">
      <Title order={2}>{t("whatIf")}</Title>
      <Text c="dimmed">{t("whatIfHint")}</Text>
      <SimpleGrid cols={{ base: 1, md: 2 }} my="md" spacing="xl">
        {shown.map((each) => (
          <Change
            key={each}
            quantity={each}
            range={rangeOf(each)}
            step={5}
            unchanged={0}
            value={values[each] ?? 0}
            onChange={(value) => setValues({ ...values, [each]: value })}
          />
        ))}
      </SimpleGrid>
      <Title order={3}>{t("otherWeights")}</Title>
      <Text size="sm" c="dimmed">
        {t("otherWeightsHint")}
      </Text>
      <SimpleGrid cols={{ base: 1, md: 2 }} my="md" spacing="xl">
        {criteria.map((each) => (
          <Change
            key={each.name}
            quantity={each.name}
            range={[0, 100]}
            step={1}
            unchanged={Math.round(100 * each.weight)}
            value={weights[each.name] ?? Math.round(100 * each.weight)}
            onChange={(value) => setWeights({ ...weights, [each.name]: value })}
          />
        ))}
      </SimpleGrid>
      <Group align="end">
        <MoreQuantities shown={shown} onAdd={(quantity) => setAdded([...added, quantity])} />
        <Button disabled={changes.length === 0} loading={predict.isPending} onClick={() => predict.mutate()}>
          {t("predict")}
        </Button>
      </Group>
      <ErrorNote error={predict.error} />
      {predict.data && (
        <Predicted asked={predict.data} resultId={resultId} />
      )}
    </Paper>
  );
}

interface ChangeProps {
  quantity: string;
  range: readonly [number, number];
  step: number;
  /** Value that changes nothing: the mark. */
  unchanged: number;
  value: number;
  onChange: (value: number) => void;
}

/** A slider in per cent. */
function Change({ quantity, range: [low, high], step, unchanged, value, onChange }: ChangeProps) {
  const { name } = useI18n();
  return (
    <div>
      <Text size="sm">
        {name(quantity)}: {value} %
      </Text>
      <Slider
        min={low}
        max={high}
        step={step}
        marks={[{ value: unchanged }]}
        styles={{ bar: { display: "none" } }}
        value={value}
        thumbLabel={name(quantity)}
        label={(shown) => `${shown} %`}
        onChange={onChange}
      />
    </div>
  );
}

/** What else may be changed by some per cent. */
function MoreQuantities({ shown, onAdd }: { shown: readonly string[]; onAdd: (quantity: string) => void }) {
  const { t, name } = useI18n();
  const about = useQuery({ queryKey: ["about"], queryFn: () => unwrap(client.GET("/api/v1/about")) });
  const more = Object.entries(about.data?.prediction_quantities ?? {}).filter(
    ([quantity, { relative_to }]) =>
      relative_to && !quantity.endsWith("_weight") && !shown.includes(quantity),
  );
  return (
    <NativeSelect
      label={t("addQuantity")}
      value=""
      onChange={(event) => event.currentTarget.value && onAdd(event.currentTarget.value)}
      data={[{ value: "", label: "–" }, ...more.map(([quantity]) => ({ value: quantity, label: name(quantity) }))]}
    />
  );
}

/** The prediction's job, and the way from its end to its curves over the measured ones. */
function Predicted({ asked, resultId }: { asked: Job; resultId: string }) {
  const { t } = useI18n();
  const path = { analysis_id: asked.id };
  const { data: job } = useQuery({
    queryKey: ["jobs", asked.id],
    queryFn: () => unwrap(client.GET("/api/v1/analyses/{analysis_id}", { params: { path } })),
    initialData: asked,
    refetchInterval: ({ state }) => (state.data && isOver(state.data) ? false : LOOK_AGAIN_MS),
  });
  return (
    <>
      <JobCard job={job} />
      {job.result_id && (
        <Anchor component={Link} href={`/compare?results=${resultId},${job.result_id}`}>
          {t("overlayPredicted")}
        </Anchor>
      )}
    </>
  );
}
