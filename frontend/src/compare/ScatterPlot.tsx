/** Any two quantities of the results against each other. */
import { useMemo, useState } from "react";
import { Group, NativeSelect, Text } from "@mantine/core";
import type uPlot from "uplot";
import { useColours } from "../app/colours";
import { Plot } from "../app/Plot";
import { useI18n } from "../i18n/I18n";
import type { Quantity, Wide } from "./wide";

interface Props {
  wide: Wide;
  labels: ReadonlyMap<string, string>;
  nameOf: (quantity: Quantity) => string;
}

export function ScatterPlot({ wide, labels, nameOf }: Props) {
  const { t, number, plain } = useI18n();
  const colours = useColours();
  const keys = wide.quantities.map((each) => each.key);
  const [across, setAcross] = useState(keys.find((key) => key.startsWith("speed")) ?? keys[0] ?? "");
  const [up, setUp] = useState(keys.find((key) => key.startsWith("gps_overall")) ?? keys[1] ?? "");
  const points = useMemo(() => {
    const known = [...wide.values].flatMap(([result, values]) => {
      const [x, y] = [values.get(across), values.get(up)];
      return x === undefined || y === undefined ? [] : [{ label: labels.get(result) ?? result, x, y }];
    });
    return known.sort((a, b) => a.x - b.x);
  }, [wide, labels, across, up]);
  const options = useMemo<Omit<uPlot.Options, "width" | "height">>(() => {
    const axis: uPlot.Axis = {
      stroke: colours.text,
      grid: { stroke: colours.grid, width: 1 },
      font: "11px system-ui",
      values: (_, ticks) => ticks.map(plain),
    };
    const title = (key: string) => {
      const quantity = wide.quantities.find((each) => each.key === key);
      return quantity ? nameOf(quantity) : key;
    };
    const roomy: uPlot.Range.Function = (_, low, high) => {
      const margin = 0.08 * (high - low || Math.abs(high) || 1);
      return [low - margin, high + margin];
    };
    return {
      scales: { x: { time: false, range: roomy }, y: { range: roomy } },
      legend: { show: false },
      cursor: { drag: { x: false, y: false } },
      axes: [
        { ...axis, label: title(across), space: 80 },
        { ...axis, label: title(up), size: 60 },
      ],
      series: [{}, { stroke: colours.right, paths: () => null, points: { show: true, size: 9, fill: colours.right } }],
      hooks: {
        draw: [
          (chart) => {
            chart.ctx.fillStyle = colours.text;
            chart.ctx.font = `${11 * devicePixelRatio}px system-ui`;
            const middle = chart.bbox.left + chart.bbox.width / 2;
            // More names than this would hide each other.
            for (const { label, x, y } of points.length <= 30 ? points : []) {
              const [left, top] = [chart.valToPos(x, "x", true), chart.valToPos(y, "y", true)];
              chart.ctx.textAlign = left < middle ? "left" : "right";
              // Its letter or its patient: whole names would lie over each other.
              chart.ctx.fillText(label.split(" · ")[0] ?? label, left + (left < middle ? 10 : -10), top - 6);
            }
          },
        ],
      },
    };
  }, [wide, colours, across, up, points, nameOf, plain]);
  const data = useMemo<uPlot.AlignedData>(() => [points.map(({ x }) => x), points.map(({ y }) => y)], [points]);
  const choices = wide.quantities.map((each) => ({ value: each.key, label: nameOf(each) }));
  return (
    <>
      <Group>
        <NativeSelect
          label={t("across")}
          value={across}
          data={choices}
          onChange={(event) => setAcross(event.currentTarget.value)}
        />
        <NativeSelect label={t("upwards")} value={up} data={choices} onChange={(event) => setUp(event.currentTarget.value)} />
      </Group>
      <Plot options={options} data={data} height={360} label={t("scatter")} />
      <Text size="sm" c="dimmed" data-testid="scatter-points">
        {points.map(({ label, x, y }) => `${label}: ${number(x, 2)} / ${number(y, 2)}`).slice(0, 30).join(" · ")}
      </Text>
    </>
  );
}
