/** Before and after, or any number of patients, side by side. */
import { useCallback, useMemo } from "react";
import { Group, Stack, Text, Title } from "@mantine/core";
import { useLocation, useSearch } from "wouter";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
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
