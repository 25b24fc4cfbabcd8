import { useMemo } from "react";
import type uPlot from "uplot";
import { Plot } from "../app/Plot";
import { useI18n } from "../i18n/I18n";
import { useColours } from "../app/colours";
import type { History } from "./progress";

/** Steps between marked iterations. */
const WHOLE = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];

/** Lines at powers of ten only: the nine between two of them would be a grey area. */
const powersOfTen: uPlot.Axis.Filter = (_, ticks) =>
  ticks.map((tick) => (Math.abs(Math.log10(tick) - Math.round(Math.log10(tick))) < 1e-9 ? tick : null));

export function ResidualChart({ history }: { history: History }) {
  const { t, plain, small } = useI18n();
  const colours = useColours();
  const options = useMemo<Omit<uPlot.Options, "width" | "height">>(() => {
    const grid: uPlot.Axis.Grid = { stroke: colours.grid, width: 1 };
    const axis: uPlot.Axis = { stroke: colours.text, grid, font: "11px system-ui", labelFont: "11px system-ui" };
    return {
      scales: { x: { time: false }, y: { distr: 3 } },
      legend: { show: false },
      axes: [
        {
          ...axis,
          size: 32,
          label: t("iterations"),
          labelSize: 18,
          incrs: WHOLE,
          values: (_, ticks) => ticks.map(plain),
        },
        {
          ...axis,
          grid: { ...grid, filter: powersOfTen },
          size: 60,
          values: (_, ticks) => ticks.map((tick) => (tick === null ? "" : small(tick))),
        },
      ],
      series: [{}, { stroke: colours.right, width: 2 }],
    };
  }, [colours, t, plain, small]);
  const data = useMemo<uPlot.AlignedData>(() => [[...history.iterations], [...history.residuals]], [history]);
  return <Plot options={options} data={data} height={160} label={t("residualCurve")} />;
}
