/** Before and after, or any number of patients, side by side. */
import { useCallback, useMemo } from "react";
import { Group, Stack, Text, Title } from "@mantine/core";
import { useQueries } from "@tanstack/react-query";
import { useLocation, useSearch } from "wouter";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { visitQuery } from "../visit/visitQuery";
import { Choice } from "./Choice";
import { Cohorts } from "./Cohorts";
import { FEW, letterOf, Overlays } from "./Overlays";
import { useAnalysed, type Named } from "./results";
import { Tables } from "./Tables";

export default function ComparePage() {
  const { t, date } = useI18n();
  const [, navigate] = useLocation();
  const search = new URLSearchParams(useSearch());
  const chosen = (search.get("results") ?? "").split(",").filter(Boolean);
  const { named, error } = useAnalysed();
  const choose = (ids: readonly string[]) => navigate(`/compare?results=${ids.join(",")}`, { replace: true });
  const labelOf = useCallback(
    ({ result, pseudonym }: Named, visit?: string) => {
      const trials = result.summary.trials as string[] | undefined;
      const kind = result.kind === "predict" ? t("prediction") : (trials?.join(", ") ?? "");
      return [pseudonym, visit ?? date(result.created_at), kind].filter(Boolean).join(" · ");
    },
    [t, date],
  );
  // Once for all, as there may be thousands.
  const labels = useMemo(() => new Map(named?.map((each) => [each.result.id, labelOf(each)])), [named, labelOf]);
  return (
    <Stack>
      <Title order={1}>{t("compare")}</Title>
      <ErrorNote error={error} />
      {named && <Choice named={named} labelOf={labelOf} chosen={chosen} choose={choose} />}
      <Cohorts chosen={chosen} choose={choose} />
      {chosen.length < 2 && <Text c="dimmed">{t("chooseTwo")}</Text>}
      {chosen.length > 1 && named && <Compared ids={chosen} named={named} labels={labels} labelOf={labelOf} />}
    </Stack>
  );
}

/** Names of a few results: a letter, and their visit rather than the day of their analysis. */
function useFewLabels(ids: readonly string[], named: readonly Named[], labelOf: LabelOf): ReadonlyMap<string, string> {
  const found = ids.map((id) => named.find(({ result }) => result.id === id));
  const visits = useVisitsOf(found.flatMap((each) => each?.result.session_id ?? []));
  return new Map(
    found.map((each, index) => {
      const visit = visits.get(each?.result.session_id ?? "");
      return [ids[index] ?? "", `${letterOf(index)} · ${each ? labelOf(each, visit) : ""}`];
    }),
  );
}

/** Name of a result, by its visit where that is known, else by the day of its analysis. */
type LabelOf = (named: Named, visit?: string) => string;

interface ComparedProps {
  ids: readonly string[];
  named: readonly Named[];
  labels: ReadonlyMap<string, string>;
  labelOf: LabelOf;
}

function Compared({ ids, named, labels, labelOf }: ComparedProps) {
  const few = ids.length <= FEW;
  const lettered = useFewLabels(few ? ids : [], named, labelOf);
  return (
    <>
      {few && (
        <Group gap="lg">
          {[...lettered.values()].map((label) => (
            <Text key={label} fw={600} size="sm">
              {label}
            </Text>
          ))}
        </Group>
      )}
      {few && <Overlays ids={ids} />}
      <Tables ids={ids} labels={few ? lettered : labels} />
    </>
  );
}

/** When visits were and whether before or after treatment, in words, by their ids. */
function useVisitsOf(ids: readonly string[]): ReadonlyMap<string, string> {
  const { t, date } = useI18n();
  const visits = useQueries({ queries: [...new Set(ids)].map(visitQuery) });
  return new Map(
    visits.flatMap(({ data }) => {
      if (!data) return [];
      const stage = data.stage === "none" ? "" : ` (${t(data.stage)})`;
      return [[data.id, date(data.visited_on) + stage]];
    }),
  );
}
