/** Share of each criterion in the cost at each instant of the cycle, stacked. */
import { useCallback, useMemo } from "react";
import { Group, Text } from "@mantine/core";
import type uPlot from "uplot";
import { criterionColour, useColours } from "../app/colours";
import { Plot } from "../app/Plot";
import { useI18n } from "../i18n/I18n";
import type { Shares } from "./walk";

const PERCENT = Array.from({ length: 101 }, (_, index) => index);

/** Upper edges of the bands, in per cent: each criterion on top of those before it. */
export function stacked(rows: Shares["rows"]): (number | null)[][] {
  return rows.map((_, upTo) =>
    PERCENT.map((percent) => {
      const parts = rows.slice(0, upTo + 1).map((row) => row[percent] ?? null);
      return parts.includes(null) ? null : 100 * parts.reduce<number>((sum, part) => sum + (part ?? 0), 0);
    }),
  );
}

export function ShareChart({ shares }: { shares: Shares }) {
  const { t, name } = useI18n();
  const colours = useColours();
  const colourOf = useCallback((index: number) => criterionColour(colours, index), [colours]);
  const options = useMemo<Omit<uPlot.Options, "width" | "height">>(() => {
    const axis: uPlot.Axis = { stroke: colours.text, grid: { stroke: colours.grid, width: 1 }, font: "11px system-ui" };
    const edges = shares.rows.map((_, index): uPlot.Series => {
      const [colour, points] = [colourOf(index), { show: false }];
      // The lowest reaches down to zero, the others down to the one below.
      return index === 0 ? { stroke: colour, fill: `${colour}cc`, points } : { stroke: colour, points };
    });
    return {
      scales: { x: { time: false, range: [0, 100] }, y: { range: [0, 100] } },
      legend: { show: false },
      cursor: { show: false },
      axes: [
        { ...axis, space: 60, label: t("percentOfCycle"), labelSize: 20 },
        { ...axis, values: (_, ticks) => ticks.map((tick) => `${tick} %`) },
      ],
      series: [{}, ...edges],
      bands: shares.rows.slice(1).map((_, index) => ({ series: [index + 2, index + 1], fill: `${colourOf(index + 1)}cc` })),
    };
  }, [shares, colours, colourOf, t]);
  const data = useMemo<uPlot.AlignedData>(() => [PERCENT, ...stacked(shares.rows)], [shares]);
  return (
    <>
      <Group gap="md">
        {shares.names.map((criterion, index) => (
          <Text size="sm" key={criterion}>
            <span className="swatch" style={{ background: colourOf(index) }} /> {name(criterion)}
          </Text>
        ))}
      </Group>
      <Plot options={options} data={data} height={220} label={t("shareOverCycle")} />
    </>
  );
}
