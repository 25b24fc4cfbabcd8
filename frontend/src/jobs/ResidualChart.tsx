import { useMemo } from "react";
import type uPlot from "uplot";
import { Plot } from "../app/Plot";
import { useI18n } from "../i18n/I18n";
import { useColours } from "../app/colours";
import type { History } from "./progress";

export function ResidualChart({ history }: { history: History }) {
  const { t } = useI18n();
  const colours = useColours();
  const options = useMemo<Omit<uPlot.Options, "width" | "height">>(
    () => ({
      scales: { x: { time: false }, y: { distr: 3 } },
      legend: { show: false },
      axes: [
        { stroke: colours.text, grid: { stroke: colours.grid }, label: t("iterations") },
        { stroke: colours.text, grid: { stroke: colours.grid }, size: 70 },
      ],
      series: [{}, { stroke: colours.right, width: 2 }],
    }),
    [colours, t],
  );
  const data = useMemo<uPlot.AlignedData>(() => [[...history.iterations], [...history.residuals]], [history]);
  return <Plot options={options} data={data} height={140} label={t("residualCurve")} />;
}
