/** Before and after, or any number of patients, side by side. */
import { useCallback, useMemo } from "react";
import { Group, Stack, Text, Title } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useLocation, useSearch } from "wouter";
import { client, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { Choice } from "./Choice";
import { Cohorts } from "./Cohorts";
import { FEW, letterOf, Overlays } from "./Overlays";
import { useAnalysed, type Named } from "./results";
import { ScatterPlot } from "./ScatterPlot";
import { SortableTable } from "./SortableTable";
import { WeightsPlot } from "./WeightsPlot";
import { widen, type Quantity } from "./wide";

export default function ComparePage() {
  const { t, date } = useI18n();
  const [, navigate] = useLocation();
  const search = new URLSearchParams(useSearch());
  const chosen = (search.get("results") ?? "").split(",").filter(Boolean);
  const { named, error } = useAnalysed();
  const choose = (ids: readonly string[]) => navigate(`/compare?results=${ids.join(",")}`, { replace: true });
  const labelOf = useCallback(
    ({ result, pseudonym }: Named) => {
      const trials = result.summary.trials as string[] | undefined;
      const kind = result.kind === "predict" ? t("prediction") : (trials?.join(", ") ?? "");
      return [pseudonym, date(result.created_at), kind].filter(Boolean).join(" · ");
    },
    [t, date],
  );
  const labels = useMemo(() => new Map(named?.map((each) => [each.result.id, labelOf(each)])), [named, labelOf]);
  return (
    <Stack>
      <Title order={1}>{t("compare")}</Title>
      <ErrorNote error={error} />
      {named && <Choice named={named} labelOf={labelOf} chosen={chosen} choose={choose} />}
      <Cohorts chosen={chosen} choose={choose} />
      {chosen.length > 1 && <Compared ids={chosen} labels={labels} />}
    </Stack>
  );
}

function Compared({ ids, labels }: { ids: readonly string[]; labels: ReadonlyMap<string, string> }) {
  const few = ids.length <= FEW;
  const named = new Map(
    ids.map((id, index) => [id, few ? `${letterOf(index)} · ${labels.get(id) ?? ""}` : (labels.get(id) ?? id)]),
  );
  return (
    <>
      {few && (
        <Group gap="lg">
          {[...named.values()].map((label) => (
            <Text key={label} fw={600} size="sm">
              {label}
            </Text>
          ))}
        </Group>
      )}
      {few && <Overlays ids={ids} />}
      <Tables ids={ids} labels={named} />
    </>
  );
}

function Tables({ ids, labels }: { ids: readonly string[]; labels: ReadonlyMap<string, string> }) {
  const { t, name } = useI18n();
  const comparison = useQuery({
    queryKey: ["comparison", ids],
    queryFn: () =>
      unwrap(
        client.POST("/api/v1/comparisons", {
          body: { members: ids.map((id) => ({ result_id: id, group: "" })), tables: ["quantities", "weights"] },
        }),
      ),
    staleTime: Infinity,
  });
  const nameOf = useCallback(
    ({ name: quantity, side, isWeight }: Quantity) =>
      [isWeight ? t("weightOf", { name: name(quantity) }) : name(quantity), side && name(side)].filter(Boolean).join(", "),
    [t, name],
  );
  const wide = useMemo(() => comparison.data && widen(comparison.data.tables, ids), [comparison.data, ids]);
  const columns = useMemo(
    () => [
      { key: "result", label: t("result") },
      ...(wide?.quantities ?? []).map((each) => ({ key: each.key, label: nameOf(each) })),
    ],
    [wide, nameOf, t],
  );
  const rows = useMemo(
    () =>
      [...(wide?.values ?? [])].map(([id, values]) => [
        labels.get(id) ?? id,
        ...(wide?.quantities ?? []).map(({ key }) => values.get(key) ?? null),
      ]),
    [wide, labels],
  );
  if (!wide) return <ErrorNote error={comparison.error} />;
  const weighted = wide.quantities.filter((each) => each.isWeight);
  return (
    <>
      {comparison.data?.problems.map((problem) => (
        <Text key={problem} size="sm">
          {problem}
        </Text>
      ))}
      <Title order={2}>{t("numbers")}</Title>
      <SortableTable name={t("numbers")} columns={columns} rows={rows} />
      {weighted.length > 0 && (
        <>
          <Title order={2}>{t("weights")}</Title>
          <WeightsPlot quantities={weighted} wide={wide} labels={labels} />
        </>
      )}
      <Title order={2}>{t("scatter")}</Title>
      <ScatterPlot wide={wide} labels={labels} nameOf={nameOf} />
    </>
  );
}
