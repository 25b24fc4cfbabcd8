/** Numbers and weights of all chosen results. */
import { useCallback, useEffect, useMemo, useState, useTransition, type ReactNode } from "react";
import { NativeSelect, Text, Title } from "@mantine/core";
import { useI18n, type Key } from "../i18n/I18n";
import { ErrorNote } from "../app/ErrorNote";
import { digitsOf } from "../result/digits";
import { ScatterPlot } from "./ScatterPlot";
import { SortableTable } from "./SortableTable";
import { useWide } from "./useWide";
import { WeightsPlot } from "./WeightsPlot";
import type { Quantity } from "./wide";

const OVERVIEW = ["speed_m_per_s", "cadence_steps_per_min", "step_length_m", "step_width_m", "gps", "gps_overall", "gdi"];
/** Which columns a choice shows. */
const GROUPS: Readonly<Record<string, (quantity: Quantity) => boolean>> = {
  overview: ({ name, isWeight }) => isWeight || OVERVIEW.includes(name),
  distances: ({ name, isWeight }) => !isWeight && !/^(gvs_|gps|gdi)/.test(name),
  profile: ({ name }) => /^(gvs_|gps|gdi)/.test(name),
  weights: ({ isWeight }) => isWeight,
  all: () => true,
};

export function Tables({ ids, labels }: { ids: readonly string[]; labels: ReadonlyMap<string, string> }) {
  const { t, name } = useI18n();
  const { wide, problems, error } = useWide(ids);
  const [group, setGroup] = useState("overview");
  const nameOf = useCallback(
    ({ name: quantity, side, isWeight }: Quantity) =>
      [isWeight ? t("weightOf", { name: name(quantity) }) : name(quantity), side && name(side)].filter(Boolean).join(", "),
    [t, name],
  );
  const columns = useMemo(
    () => [
      { key: "result", label: t("result") },
      ...(wide?.quantities ?? []).map((each) => ({
        key: each.key,
        label: nameOf(each),
        digits: digitsOf(each.name),
      })),
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
  const shown = useMemo(() => {
    const wanted = GROUPS[group] ?? (() => true);
    return [0, ...(wide?.quantities ?? []).flatMap((each, index) => (wanted(each) ? [index + 1] : []))];
  }, [wide, group]);
  if (!wide) return <ErrorNote error={error} />;
  const weighted = wide.quantities.filter((each) => each.isWeight);
  return (
    <>
      {problems.map((problem) => (
        <Text key={problem} size="sm">
          {problem}
        </Text>
      ))}
      <Title order={2}>{t("numbers")}</Title>
      <NativeSelect
        className="no-print"
        w={240}
        label={t("columns")}
        value={group}
        onChange={(event) => setGroup(event.currentTarget.value)}
        data={Object.keys(GROUPS).map((value) => ({ value, label: t(`columns_${value}` as Key) }))}
      />
      <SortableTable name={t("numbers")} columns={columns} rows={rows} shown={shown} />
      {weighted.length > 0 && (
        <Later>
          <Title order={2}>{t("weights")}</Title>
          <WeightsPlot quantities={weighted} wide={wide} labels={labels} />
        </Later>
      )}
      <Later>
        <Title order={2}>{t("scatter")}</Title>
        <ScatterPlot wide={wide} labels={labels} nameOf={nameOf} />
      </Later>
    </>
  );
}

/** Drawn when the rest is there, a piece at a time, so that the page stays quick. */
function Later({ children }: { children: ReactNode }) {
  const [ready, setReady] = useState(false);
  const [, startTransition] = useTransition();
  useEffect(() => startTransition(() => setReady(true)), []);
  return ready ? children : null;
}
