/** Curves of a few results over each other: colour is side, line style is session. */
import { useMemo, useState } from "react";
import { Checkbox, Group, Text, Title } from "@mantine/core";
import { useQueries } from "@tanstack/react-query";
import { useI18n } from "../i18n/I18n";
import { CyclePanel, type Line, type PanelData } from "../result/CyclePanel";
import { Cursor } from "../result/cursor";
import { SIDES, type ResultDocument, type Side } from "../result/document";
import { KINEMATICS, KINETICS } from "../result/panels";
import { documentQuery } from "../result/useResultDocument";

/** Line styles of the sessions, in the order in which they were chosen. */
const DASHES: (number[] | undefined)[] = [undefined, [8, 4], [2, 3], [10, 3, 2, 3]];
export const FEW = DASHES.length;

export function letterOf(index: number): string {
  return String.fromCharCode(65 + index);
}

export function Overlays({ ids }: { ids: readonly string[] }) {
  const { t } = useI18n();
  const cursor = useMemo(() => new Cursor(), []);
  const [kinetics, setKinetics] = useState(false);
  const documents = useQueries({
    queries: ids.map(documentQuery),
    combine: (all) => all.flatMap(({ data }) => (data ? [data] : [])),
  });
  const panels = useMemo(() => {
    const layouts = kinetics ? KINETICS : KINEMATICS;
    const words = { left: t("left"), right: t("right") };
    return layouts.map((layout) => layout && { layout, data: overlay(layout.name, documents, words) });
  }, [documents, kinetics, t]);
  if (documents.length < ids.length) return null;
  return (
    <>
      <Group justify="space-between">
        <Title order={2}>{t("curves")}</Title>
        <Checkbox label={t("kinetics")} checked={kinetics} onChange={(event) => setKinetics(event.currentTarget.checked)} />
      </Group>
      <Text size="sm">{t("overlayLegend")}</Text>
      <div className="panels">
        {panels.map((panel, index) =>
          panel ? (
            <CyclePanel key={panel.layout.name} layout={panel.layout} data={panel.data} cursor={cursor} />
          ) : (
            <div key={index} className="hole" />
          ),
        )}
      </div>
    </>
  );
}

function overlay(name: string, documents: readonly ResultDocument[], words: Readonly<Record<Side, string>>): PanelData {
  const lines = documents.flatMap((document, index) =>
    SIDES.flatMap((side): Line[] => {
      const curve = (document.kinematics[name] ?? document.kinetics?.curves[name])?.[side];
      const dash = DASHES[index];
      const label = `${letterOf(index)} ${words[side]}`;
      return curve ? [{ side, mean: curve.mean, label, ...(dash ? { dash } : {}) }] : [];
    }),
  );
  const reference = documents[0]?.scores?.reference;
  return { lines, norm: reference?.curves[name] ?? reference?.kinetics?.[name], footOff: {} };
}
