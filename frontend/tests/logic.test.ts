import { describe, expect, it } from "vitest";
import { problemOf } from "../src/api/client";
import { compareCells } from "../src/compare/compareCells";
import { fill } from "../src/i18n/fill";
import { advance, NOTHING, secondsLeft } from "../src/jobs/progress";
import { percentAt, strideOf, stridesIn, timeAt, trialIn } from "../src/result/cycle";
import { parseTable, resample } from "../src/result/table";
import { changesOf } from "../src/result/changes";
import { foundIn } from "../src/visit/inspection";
import { isWanted } from "../src/visit/upload";

const stride = { trial: "walk", side: "left", start_s: 1, end_s: 2, outlier: [], representative: false } as const;

describe("cycle", () => {
  const strides = [{ ...stride }, { ...stride, start_s: 2, end_s: 4, representative: true }].map((each) => ({
    ...each,
    outlier: [...each.outlier],
  }));

  it("goes from percent to time and back", () => {
    const chosen = strideOf(strides, "walk", "left");
    expect(chosen?.start_s).toBe(2);
    expect(timeAt(strides[1]!, 25)).toBe(2.5);
    expect(percentAt(strides, "walk", "left", 2.5)).toBe(25);
    expect(percentAt(strides, "walk", "left", 1.5)).toBe(50);
  });

  it("knows no percent outside of strides or on the other side", () => {
    expect(percentAt(strides, "walk", "left", 4.5)).toBeNull();
    expect(percentAt(strides, "walk", "right", 2.5)).toBeNull();
  });
});

it("makes strides of foot strikes where a result lists none", () => {
  const strike = (side: "left" | "right", time_s: number) => ({ side, kind: "foot_strike", time_s, trial: "walk" });
  const strides = stridesIn({ events: [strike("left", 2), strike("right", 1.5), strike("left", 1)] });
  expect(strides).toEqual([{ trial: "walk", side: "left", start_s: 1, end_s: 2 }]);
  expect(trialIn(strides, "result")).toBe("walk");
});

describe("table", () => {
  it("interpolates between frames and keeps what is unknown", () => {
    const table = parseTable("time,left_knee\n0,0\n1,10\n2,\n");
    const known = resample(table, "left_knee", { start_s: 0, end_s: 1 });
    expect(known).toHaveLength(101);
    expect(known[50]).toBeCloseTo(5);
    expect(resample(table, "left_knee", { start_s: 0, end_s: 2 })[75]).toBeNull();
  });
});

describe("progress", () => {
  it("collects a residual curve and begins anew with a stage", () => {
    const first = advance(NOTHING, { stage: "weights", trial: "a", iteration: 1, residual: 1 });
    const second = advance(first, { stage: "weights", trial: "a", iteration: 2, residual: 0.1 });
    expect(second.residuals).toEqual([1, 0.1]);
    expect(advance(second, { stage: "report", trial: "a" }).residuals).toEqual([]);
    expect(advance(second, { stage: "weights", trial: "a", iteration: 1, residual: 5 }).residuals).toEqual([5]);
  });

  it("expects the rest from what is done", () => {
    expect(secondsLeft({ done: 0.25, seconds: 10 })).toBe(30);
    expect(secondsLeft({ seconds: 10 })).toBeNull();
  });
});

describe("texts", () => {
  it("fills places and leaves unknown ones", () => {
    expect(fill("{count} markers of {whom}", { count: 3 })).toBe("3 markers of {whom}");
  });

  it("says what the server said", () => {
    expect(problemOf({ detail: "no such patient" }, 404).message).toBe("no such patient");
    expect(problemOf(undefined, 502).message).toBe("HTTP 502");
  });
});

describe("visit", () => {
  it("reads the rows of an inspection", () => {
    const rows = [["markers", "LASI, RASI"], ["body parameters", "mass 31.5, left_leg_length 0.71"], ["warnings", "none"]];
    const found = foundIn({ inspection: { rows } });
    expect(found?.markers).toEqual(["LASI", "RASI"]);
    expect(found?.parameters).toEqual({ mass: 31.5, left_leg_length: 0.71 });
    expect(found?.warnings).toEqual([]);
    expect(foundIn({ inspection: null })).toBeNull();
  });

  it("takes recordings and videos", () => {
    expect(["a.C3D", "b.mp4", "c.txt"].map(isWanted)).toEqual([true, true, false]);
  });
});

it("writes changes as the command line does", () => {
  expect(changesOf({ speed: 10, mass: -5, left: 0 })).toEqual(["speed=+10%", "mass=-5%"]);
});

it("sorts unknown cells last", () => {
  expect([null, 2, 1].sort(compareCells)).toEqual([1, 2, null]);
});
