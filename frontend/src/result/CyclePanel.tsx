/** One curve of both sides over the cycle, with the reference band, foot-off lines and the shared cursor. */
import { useEffect, useMemo, useRef, type KeyboardEvent } from "react";
import { Paper, Text } from "@mantine/core";
import uPlot from "uplot";
import { useColours, type Colours } from "../app/colours";
import { useI18n, type Key } from "../i18n/I18n";
import type { Cursor } from "./cursor";
import { SIDES, type Band, type Side, type Values } from "./document";
import type { PanelLayout } from "./panels";

const HEIGHT = 170;
const TICK = 8;
/** Per cent of the cycle that a key moves the cursor by. */
const STEPS: Readonly<Record<string, number>> = { ArrowLeft: -1, ArrowRight: 1, PageDown: -10, PageUp: 10, Home: -100, End: 100 };

/** One line of a panel; `dash` tells sessions apart, colour sides. */
export interface Line {
  side: Side;
  mean: Values;
  /** Missing where single cycles are shown. */
  sd?: Values;
  dash?: number[];
  faint?: boolean;
  label: string;
}

export interface PanelData {
  lines: readonly Line[];
  norm?: Band | undefined;
  /** Per cent of the cycle at which each foot leaves the floor. */
  footOff: Readonly<Partial<Record<Side, number | null>>>;
  /** Per cent at which the opposite foot leaves the floor and comes down. */
  opposite?: Readonly<Partial<Record<Side, readonly (number | null)[]>>>;
}

interface Props {
  layout: PanelLayout;
  data: PanelData;
  cursor: Cursor;
  onPick?: (name: string) => void;
}

type Row = (number | null)[];
const PERCENT = Array.from({ length: 101 }, (_, index) => index);

function shifted(mean: Values, sd: Values, sign: number): Row {
  return mean.map((value, index) => {
    const spread = sd[index];
    return value == null || spread == null ? null : value + sign * spread;
  });
}

/** Series, bands and rows of numbers of a panel. */
function build({ lines, norm }: PanelData, colours: Colours) {
  const rows: Row[] = [];
  const series: uPlot.Series[] = [{}];
  const bands: uPlot.Band[] = [];
  const add = (row: Row, options: uPlot.Series) => {
    rows.push(row);
    series.push({ points: { show: false }, ...options });
  };
  const addBand = (mean: Values, sd: Values, fill: string) => {
    add(shifted(mean, sd, 1), { stroke: "transparent" });
    add(shifted(mean, sd, -1), { stroke: "transparent" });
    bands.push({ series: [series.length - 2, series.length - 1], fill });
  };
  if (norm) addBand(norm.mean, norm.sd, colours.band);
  for (const line of lines) {
    const colour = colours[line.side];
    if (line.sd) addBand(line.mean, line.sd, `${colour}26`);
    add([...line.mean], {
      stroke: line.faint ? `${colour}99` : colour,
      width: line.faint ? 1 : 2,
      label: line.label,
      ...(line.dash ? { dash: line.dash } : {}),
    });
  }
  return { series, bands, data: [PERCENT, ...rows] as uPlot.AlignedData };
}

function drawMarks(chart: uPlot, { footOff, opposite }: PanelData, colours: Colours): void {
  const { ctx, bbox } = chart;
  ctx.save();
  ctx.lineWidth = devicePixelRatio;
  // The last line drawn may have been dashed.
  ctx.setLineDash([]);
  const zero = chart.valToPos(0, "y", true);
  ctx.strokeStyle = colours.text;
  ctx.globalAlpha = 0.5;
  ctx.beginPath();
  ctx.moveTo(bbox.left, zero);
  ctx.lineTo(bbox.left + bbox.width, zero);
  ctx.stroke();
  ctx.globalAlpha = 1;
  for (const side of SIDES) {
    ctx.strokeStyle = colours[side];
    const line = (percent: number | null | undefined, length: number) => {
      if (percent == null) return;
      const x = chart.valToPos(percent, "x", true);
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + length);
      ctx.stroke();
    };
    line(footOff[side], bbox.height);
    for (const percent of opposite?.[side] ?? []) line(percent, TICK * devicePixelRatio);
  }
  ctx.restore();
}

/** Arrow keys move the cursor, Enter does what a click does. */
function byKey(event: KeyboardEvent, cursor: Cursor, pick: () => void): void {
  if (event.key === "Enter") return pick();
  const step = STEPS[event.key];
  if (step === undefined) return;
  event.preventDefault();
  const percent = cursor.percent === null ? 0 : cursor.percent + step;
  cursor.move(Math.min(Math.max(percent, 0), 100), null);
}

export function CyclePanel({ layout, data, cursor, onPick }: Props) {
  const { name, t, number, plain, unit } = useI18n();
  const colours = useColours();
  const place = useRef<HTMLDivElement>(null);
  const readout = useRef<HTMLDivElement>(null);
  const built = useMemo(() => build(data, colours), [data, colours]);
  const ways = layout.directions.filter(Boolean).map((each) => t(`way_${each}` as Key));
  const title = name(layout.name);

  useEffect(() => {
    const element = place.current;
    if (!element) return undefined;
    const axis: uPlot.Axis = {
      stroke: colours.text,
      grid: { stroke: colours.grid, width: 1 },
      ticks: { show: false },
      font: "11px system-ui",
      values: (_, ticks) => ticks.map(plain),
    };
    const chart = new uPlot(
      {
        width: element.clientWidth,
        height: HEIGHT,
        scales: { x: { time: false, range: [0, 100] }, y: { range: [layout.scale[0], layout.scale[1]] } },
        axes: [
          { ...axis, size: 24, space: 40 },
          { ...axis, size: 36, space: 28 },
        ],
        legend: { show: false },
        cursor: { y: false, drag: { x: false, y: false }, points: { show: false } },
        series: built.series,
        bands: built.bands,
        hooks: {
          draw: [(drawn) => drawMarks(drawn, data, colours)],
          setCursor: [
            (moved) => {
              const { left } = moved.cursor;
              cursor.move(left == null || left < 0 ? null : moved.posToVal(left, "x"), moved);
            },
          ],
        },
      },
      built.data,
      element,
    );
    const leave = cursor.join(chart);
    const observer = new ResizeObserver(() => chart.setSize({ width: element.clientWidth, height: HEIGHT }));
    observer.observe(element);
    return () => {
      observer.disconnect();
      leave();
      chart.destroy();
    };
  }, [built, colours, cursor, data, layout, plain]);

  useEffect(() => {
    // A moment or power of 0.04 is none that is zero.
    const digits = layout.scale[1] - layout.scale[0] < 20 ? 2 : 1;
    const marked = data.lines.filter((line) => !line.faint);
    return cursor.listen((percent) => {
      if (!readout.current) return;
      readout.current.textContent =
        percent === null
          ? ""
          : marked.map((line) => `${line.label} ${number(line.mean[Math.round(percent)], digits)}`).join("  ");
    });
  }, [cursor, data.lines, layout, number]);

  return (
    <Paper withBorder p={6} component="figure" m={0}>
      <Text component="figcaption" size="sm" fw={600}>
        {title}{" "}
        <Text span size="xs" c="dimmed">
          {ways.join(" / ")} [{unit(layout.unit)}]
        </Text>
      </Text>
      <div
        ref={place}
        role="img"
        aria-label={t("curveOf", { name: title })}
        tabIndex={0}
        onKeyDown={(event) => byKey(event, cursor, () => onPick?.(layout.name))}
        style={{ minHeight: HEIGHT, cursor: onPick ? "pointer" : undefined }}
        onClick={() => onPick?.(layout.name)}
      />
      <Text ref={readout} size="xs" mih={18} data-testid={`readout-${layout.name}`} />
    </Paper>
  );
}
