/** The measured and the model-optimal walk of the stride that the weights explain, over its cycle. */
import { useQuery } from "@tanstack/react-query";
import { stridesIn } from "./cycle";
import { SIDES, type ResultDocument, type Side, type Stride, type Values } from "./document";
import { readFile, trialFile } from "./files";
import { readNpz, type Arrays, type NumberArray } from "./npz";
import type { PanelLayout } from "./panels";

const WANTED = ["time", "criteria_share", "criteria_names", "q_measured", "q_optimal", "segment_names"];
const DEGREES = 180 / Math.PI;

/** A joint angle of the model under the clinical signs: segment, axis (y, x, z) and sign of the right side. */
interface Angle {
  layout: PanelLayout;
  segment: string;
  axis: number;
  /** Of left and right. */
  signs: Readonly<Record<Side, number>>;
}

function angle(name: string, segment: string, axis: number, sign: number, scale: readonly [number, number]): Angle {
  // About the sagittal axis both sides turn alike, about the others they mirror each other.
  const signs = { right: sign, left: axis === 0 ? sign : -sign };
  return { layout: { name, scale, directions: ["", ""], unit: "deg" }, segment, axis, signs };
}

export const ANGLES: readonly Angle[] = [
  angle("hip_flexion", "thigh", 0, -1, [-30, 70]),
  angle("hip_adduction", "thigh", 1, 1, [-30, 30]),
  angle("hip_rotation", "thigh", 2, 1, [-40, 40]),
  angle("knee_flexion", "shank", 0, 1, [-20, 80]),
  angle("ankle_dorsiflexion", "foot", 0, -1, [-50, 40]),
];

/** Shares of the criteria at each percent, summing to one; null where unknown. */
export interface Shares {
  names: readonly string[];
  /** Criterion by criterion, 101 samples each. */
  rows: Values[];
}

export interface Walk {
  stride: Stride;
  shares: Shares | null;
  /** By name of the angle and side: measured, and model-optimal where there is one. */
  angles: Readonly<Record<string, Readonly<Record<Side, { measured: Values; optimal: Values | null }>>>>;
}

/** The stride that the weights explain, else the representative one, else the first. */
export function explainedStride(document: Pick<ResultDocument, "strides" | "events" | "weights">): Stride | undefined {
  const strides = stridesIn(document);
  return document.weights?.strides?.[0] ?? strides.find((each) => each.representative) ?? strides[0];
}

/** 101 samples of a column over a stride, linear between frames; null where either frame is unknown. */
export function sample(time: Float64Array, array: NumberArray, column: number, stride: Stride): (number | null)[] {
  const width = array.shape[1] ?? 1;
  let after = 1;
  return Array.from({ length: 101 }, (_, percent) => {
    const moment = stride.start_s + (percent / 100) * (stride.end_s - stride.start_s);
    while (after < time.length - 1 && (time[after] ?? 0) < moment) after += 1;
    const [t0 = NaN, t1 = NaN] = [time[after - 1], time[after]];
    const [y0 = NaN, y1 = NaN] = [array.values[(after - 1) * width + column], array.values[after * width + column]];
    const value = y0 + ((y1 - y0) * (moment - t0)) / (t1 - t0);
    return Number.isFinite(value) ? value : null;
  });
}

/** What each criterion costs of all at that instant. */
export function sharesOf(arrays: Arrays, stride: Stride, names: readonly string[]): Shares | null {
  const [time, cost] = [arrays.numbers.get("time"), arrays.numbers.get("criteria_share")];
  if (!time || !cost) return null;
  const stored = arrays.texts.get("criteria_names") ?? names;
  const costs = Array.from({ length: cost.shape[1] ?? 0 }, (_, column) => sample(time.values, cost, column, stride));
  const totals = Array.from({ length: 101 }, (_, percent) =>
    costs.reduce((sum, row) => sum + Math.max(row[percent] ?? NaN, 0), 0),
  );
  const rows = costs.map((row) =>
    row.map((value, percent) => {
      const total = totals[percent] ?? NaN;
      return value === null || !(total > 0) ? null : Math.max(value, 0) / total;
    }),
  );
  if (rows.every((row) => row.every((value) => value === null))) return null;
  return { names: rows.map((_, column) => stored[column] ?? String(column + 1)), rows };
}

function anglesOf(arrays: Arrays, stride: Stride): Walk["angles"] {
  const [time, measured] = [arrays.numbers.get("time"), arrays.numbers.get("q_measured")];
  if (!time || !measured) return {};
  const optimal = arrays.numbers.get("q_optimal");
  const segments = arrays.texts.get("segment_names") ?? [];
  const read = (array: NumberArray, { segment, axis, signs }: Angle, side: Side) => {
    const column = 3 + 3 * segments.indexOf(`${side}_${segment}`) + axis;
    const factor = DEGREES * signs[side];
    return sample(time.values, array, column, stride).map((value) => (value === null ? null : factor * value));
  };
  return Object.fromEntries(
    ANGLES.filter(({ segment }) => SIDES.every((side) => segments.includes(`${side}_${segment}`))).map((each) => {
      const sides = SIDES.map((side) => [
        side,
        { measured: read(measured, each, side), optimal: optimal ? read(optimal, each, side) : null },
      ]);
      return [each.layout.name, Object.fromEntries(sides)];
    }),
  ) as Walk["angles"];
}

async function readWalk(resultId: string, document: ResultDocument): Promise<Walk | null> {
  const stride = explainedStride(document);
  if (!stride) return null;
  const trials = [...new Set(stridesIn(document).map((each) => each.trial))];
  const file = await readFile(resultId, trialFile(trials, stride.trial, "walk.npz"));
  if (!file) return null;
  const arrays = await readNpz(await file.arrayBuffer(), WANTED);
  const criteria = document.weights?.criteria.map((each) => each.name) ?? [];
  return { stride, shares: sharesOf(arrays, stride, criteria), angles: anglesOf(arrays, stride) };
}

export function useWalk(resultId: string, document: ResultDocument) {
  return useQuery({
    queryKey: ["walk", resultId],
    queryFn: () => readWalk(resultId, document),
    staleTime: Infinity,
  });
}
