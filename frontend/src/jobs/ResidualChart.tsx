import { useMemo } from "react";
import type uPlot from "uplot";
import { Plot } from "../app/Plot";
import { useI18n } from "../i18n/I18n";
import { useColours } from "../app/colours";
import type { History } from "./progress";

export function ResidualChart({ history }: { history: History }) {
  const { t, plain, small } = useI18n();
  const colours = useColours();
  const options = useMemo<Omit<uPlot.Options, "width" | "height">>(() => {
    const axis: uPlot.Axis = { stroke: colours.text, grid: { stroke: colours.grid, width: 1 } };
    return {
      scales: { x: { time: false }, y: { distr: 3 } },
      legend: { show: false },
      axes: [
        { ...axis, label: t("iterations"), values: (_, ticks) => ticks.map(plain) },
        { ...axis, size: 70, values: (_, ticks) => ticks.map((tick) => (tick === null ? "" : small(tick))) },
      ],
      series: [{}, { stroke: colours.right, width: 2 }],
    };
  }, [colours, t, plain, small]);
  const data = useMemo<uPlot.AlignedData>(() => [[...history.iterations], [...history.residuals]], [history]);
  return <Plot options={options} data={data} height={140} label={t("residualCurve")} />;
}
