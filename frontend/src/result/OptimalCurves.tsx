/** Measured against model-optimal joint angles of the stride that the weights explain. */
import { useMemo } from "react";
import { Text } from "@mantine/core";
import { useI18n } from "../i18n/I18n";
import { CyclePanel, type Line } from "./CyclePanel";
import { Cursor } from "./cursor";
import { SIDES } from "./document";
import { ANGLES, type Walk } from "./walk";

const NO_MARKS = {};
const DASH = [4, 4];

export function OptimalCurves({ walk }: { walk: Walk }) {
  const { t, number } = useI18n();
  const cursor = useMemo(() => new Cursor(), []);
  const panels = useMemo(
    () =>
      ANGLES.filter(({ layout }) => layout.name in walk.angles).map(({ layout }) => {
        const lines = SIDES.flatMap((side): Line[] => {
          const curves = walk.angles[layout.name]?.[side];
          if (!curves) return [];
          const { measured, optimal } = curves;
          const label = t(side);
          const model: Line[] = optimal ? [{ side, mean: optimal, dash: DASH, label: t("ofModel", { name: label }) }] : [];
          return [{ side, mean: measured, label }, ...model];
        });
        return { layout, data: { lines, footOff: NO_MARKS } };
      }),
    [walk, t],
  );
  const { trial, side, start_s, end_s } = walk.stride;
  return (
    <>
      <Text size="sm" c="dimmed">
        {t("optimalLegend", { trial, side: t(side).toLowerCase(), start: number(start_s, 2), end: number(end_s, 2) })}
      </Text>
      <div className="panels">
        {panels.map(({ layout, data }) => (
          <CyclePanel key={layout.name} layout={layout} data={data} cursor={cursor} />
        ))}
      </div>
    </>
  );
}
