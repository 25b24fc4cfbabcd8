import { describe, expect, it } from "vitest";
import { auditQuery, EVERYTHING } from "../src/admin/auditQuery";
import { problemOf } from "../src/api/client";
import { compareCells } from "../src/compare/compareCells";
import { meets } from "../src/compare/filters";
import { csvCell, widen } from "../src/compare/wide";
import { en } from "../src/i18n/en";
import { fill } from "../src/i18n/fill";
import { nameIn } from "../src/i18n/names";
import { strideIn } from "../src/i18n/stride";
import { advance, NOTHING, secondsLeft } from "../src/jobs/progress";
import { percentAt, strideOf, stridesIn, timeAt, trialIn } from "../src/result/cycle";
import { readNpz } from "../src/result/npz";
import { stacked } from "../src/result/ShareChart";
import { parseTable, resample } from "../src/result/table";
import { sharesOf } from "../src/result/walk";
import { changesOf, weightChangesOf } from "../src/result/changes";
import { byTrial, countsIn, eventsIn } from "../src/visit/events";
import { foundIn } from "../src/visit/inspection";
import { axisOf, movedByKey, snapped, stancesOf, ticksOf, withTime } from "../src/visit/timeAxis";
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

  it("finds the stride that the server names", () => {
    expect(strideIn("weights, left stride at 1.56 s")).toEqual({ before: "weights", side: "left", start_s: 1.56 });
    expect(strideIn("right 0.5 s")).toEqual({ before: "", side: "right", start_s: 0.5 });
    expect(strideIn("joint angles")).toBeNull();
  });

  it("puts names of sides, muscles and limits together", () => {
    const names = ["left_hip_flexor_limit", "right_knee_extensor_peak_nm_per_kg", "torque_weight", "gvs_knee_flexion"];
    expect(names.map((each) => nameIn(en, each))).toEqual([
      "Strength of the hip flexors, left",
      "Largest torque of the knee extensors [N·m/kg], right",
      "Weight: Joint torque",
      "GVS Knee flexion",
    ]);
    expect(nameIn(en, "left_unheard_of")).toBe("Left unheard of");
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
    expect(found?.timing).toBeNull();
    expect(foundIn({ inspection: null })).toBeNull();
  });

  it("knows when frames are and what the plates measured", () => {
    const rows = [["frames", "361 at 100 Hz, 3.61 s, first 0"], ["force plates", "1: up to 569 N at 1000 Hz"]];
    const found = foundIn({ inspection: { rows } });
    expect(found?.timing).toEqual({ frames: 361, rate: 100 });
    expect(found?.plates).toEqual([{ number: 1, newton: 569, rate: 1000 }]);
  });

  it("takes recordings and videos", () => {
    expect(["a.C3D", "b.mp4", "c.txt"].map(isWanted)).toEqual([true, true, false]);
  });
});

it("asks the audit log for whole days and for what was filled in", () => {
  expect(auditQuery({ ...EVERYTHING, action: "login" })).toEqual({ action: "login" });
  const { after, before } = auditQuery({ ...EVERYTHING, from: "2026-11-20", to: "2026-11-20" });
  expect(Date.parse(before ?? "") - Date.parse(after ?? "")).toBe(24 * 3600 * 1000);
});

it("writes changes as the command line does", () => {
  expect(changesOf({ speed: 10, mass: -5, left: 0 })).toEqual(["speed=+10%", "mass=-5%"]);
});

it("asks only for weights that were moved", () => {
  const identified = [
    { name: "torque", weight: 0.304 },
    { name: "lateral_stability", weight: 0.696 },
  ];
  expect(weightChangesOf({ torque: 30 }, identified)).toEqual([]);
  expect(weightChangesOf({ torque: 45, lateral_stability: 0 }, identified)).toEqual([
    "torque_weight=0.45",
    "lateral_stability_weight=0",
  ]);
});

it("sorts unknown cells last", () => {
  expect([null, 2, 1].sort((a, b) => compareCells(a, b))).toEqual([1, 2, null]);
  expect([null, 1, 2].sort((a, b) => compareCells(a, b, -1))).toEqual([2, 1, null]);
});

describe("npz", () => {
  // numpy: savez_compressed(time=[0.0, 0.5, 1.0], criteria_share=[[1.0, 3.0], [2.0, 2.0], [0.0, 4.0]], criteria_names=["a", "bö"])
  const NPZ = 
    "UEsDBC0AAAAIAAAAIQDcLUnY//////////8IABQAdGltZS5ucHkBABAAmAAAAAAAAABNAAAAAAAAAJvsF+obEMnIUMZQrZ6SWpxc" +
    "pG6loG6TZqGuo6Cell9UUpSYF59flJIKEndLzClOBYoXZyQWpAL5GsY6mjoKtQoUAC4GFPDAHkJ/sAcAUEsDBC0AAAAIAAAAIQCP" +
    "+QEU//////////8SABQAY3JpdGVyaWFfc2hhcmUubnB5AQAQALAAAAAAAAAAVgAAAAAAAACb7BfqGxDJyFDGUK2eklqcXKRupaBu" +
    "k2ahrqOgnpZfVFKUmBefX5SSChJ3S8wpTgWKF2ckFqQC+RrGOgpGmjoKtQpkAy4GMPhgD6E5HCA0AzoNBQIOAFBLAwQtAAAACAAA" +
    "ACEA5lbzHP//////////EgAUAGNyaXRlcmlhX25hbWVzLm5weQEAEACQAAAAAAAAAE0AAAAAAAAAm+wX6hsQychQxlCtnpJanFyk" +
    "bqWgbhNqpK6joJ6WX1RSlJgXn1+UkgoSd0vMKU4FihdnJBakAvkaRjqaOgq1ChQArkQGCEgC4m9ADABQSwECLQMtAAAACAAAACEA" +
    "3C1J2E0AAACYAAAACAAAAAAAAAAAAAAAgAEAAAAAdGltZS5ucHlQSwECLQMtAAAACAAAACEAj/kBFFYAAACwAAAAEgAAAAAAAAAA" +
    "AAAAgAGHAAAAY3JpdGVyaWFfc2hhcmUubnB5UEsBAi0DLQAAAAgAAAAhAOZW8xxNAAAAkAAAABIAAAAAAAAAAAAAAIABIQEAAGNy" +
    "aXRlcmlhX25hbWVzLm5weVBLBQYAAAAAAwADALYAAACyAQAAAAA=";
  const bytes = Uint8Array.from(atob(NPZ), (letter) => letter.charCodeAt(0)).buffer;

  it("is read as numpy wrote it", async () => {
    const { numbers, texts } = await readNpz(bytes, ["time", "criteria_share", "criteria_names"]);
    expect([...(numbers.get("time")?.values ?? [])]).toEqual([0, 0.5, 1]);
    expect(numbers.get("criteria_share")?.shape).toEqual([3, 2]);
    expect(texts.get("criteria_names")).toEqual(["a", "bö"]);
  });

  it("gives shares that sum to one at each instant", async () => {
    const arrays = await readNpz(bytes, ["time", "criteria_share"]);
    const shares = sharesOf(arrays, { trial: "walk", side: "left", start_s: 0, end_s: 1 }, ["x", "y"]);
    expect(shares?.names).toEqual(["x", "y"]);
    expect([shares?.rows[0]?.[0], shares?.rows[0]?.[50], shares?.rows[0]?.[100]]).toEqual([0.25, 0.5, 0]);
    expect(stacked(shares?.rows ?? [])[1]?.every((edge) => Math.abs((edge ?? 0) - 100) < 1e-9)).toBe(true);
  });
});

describe("events", () => {
  it("come out of the inspection's row", () => {
    expect(eventsIn("left foot strike 0.5120, right foot off 0.6300")).toEqual([
      { side: "left", kind: "foot_strike", time_s: 0.512 },
      { side: "right", kind: "foot_off", time_s: 0.63 },
    ]);
    expect(eventsIn("none")).toEqual([]);
  });

  it("are sent in time order under the trial's name, only where they were corrected", () => {
    const recordings = [{ id: "1", name: "walk1.c3d" }, { id: "2", name: "walk2.c3d" }];
    const [late, early] = [0.9, 0.2].map((time_s) => ({ side: "left", kind: "foot_off", time_s }) as const);
    expect(byTrial({ "1": [late!, early!] }, recordings)).toEqual({ walk1: [early, late] });
  });
});

it("counts events of each kind", () => {
  expect(countsIn("3 left foot off, 2 right foot strike")).toEqual([
    { count: 3, side: "left", kind: "foot_off" },
    { count: 2, side: "right", kind: "foot_strike" },
  ]);
  expect(countsIn("none")).toEqual([]);
});

describe("time line", () => {
  const event = (side: "left" | "right", kind: "foot_strike" | "foot_off", time_s: number) => ({ side, kind, time_s });
  const events = [event("left", "foot_off", 0.2), event("left", "foot_strike", 0.6), event("right", "foot_off", 1.4)];
  const axis = axisOf({ frames: 201, rate: 100 }, events);

  it("goes from the first frame to the last, or as far as the events need", () => {
    expect(axis.end).toBe(2);
    expect(axisOf(null, events).end).toBe(2);
    expect(axisOf(null, []).end).toBe(1);
  });

  it("snaps to frames of the recording", () => {
    expect([0.6149, -1, 9].map((time) => snapped(time, axis))).toEqual([0.61, 0, 2]);
    expect(snapped(0.5, axisOf({ frames: 121, rate: 120 }, []))).toBe(0.5);
  });

  it("moves by a frame, by ten and to the ends", () => {
    const keys = ["ArrowLeft", "ArrowRight", "PageUp", "Home", "End", "Enter"];
    expect(keys.map((key) => movedByKey(0.6, key, axis))).toEqual([0.59, 0.61, 0.7, 0, 2, null]);
  });

  it("moves one event and leaves the others in their order", () => {
    expect(withTime(events, 1, 1.9).map(({ time_s }) => time_s)).toEqual([0.2, 1.9, 1.4]);
  });

  it("shows when a foot is on the floor", () => {
    expect(stancesOf(events, "left", axis)).toEqual([[0, 0.2], [0.6, 2]]);
    expect(stancesOf(events, "right", axis)).toEqual([[0, 1.4]]);
  });

  it("has few round ticks", () => {
    expect(ticksOf(axis)).toEqual([0, 0.2, 0.4, 0.6, 0.8, 1, 1.2, 1.4, 1.6, 1.8, 2]);
    expect(ticksOf({ end: 0.3, frame: 0.01 })).toEqual([0, 0.1, 0.2, 0.3]);
  });
});

describe("comparison", () => {
  const tables = {
    quantities: {
      columns: ["result", "group", "quantity", "side", "value"],
      rows: [["a", "", "gps", "left", 7], ["b", "", "gps", "left", 9], ["a", "", "gps_overall", "", 8]],
    },
    weights: { columns: ["result", "criterion", "weight"], rows: [["b", "torque", 0.4]] },
  };

  it("makes a row of each result", () => {
    const { quantities, values } = widen(tables, ["a", "b"]);
    expect(quantities.map(({ key }) => key)).toEqual(["gps left", "gps_overall", "weight torque"]);
    expect([values.get("a")?.get("gps left"), values.get("b")?.get("weight torque")]).toEqual([7, 0.4]);
    expect(values.get("b")?.has("gps_overall")).toBe(false);
  });

  it("filters by words and by conditions", () => {
    const columns = ["result", "gps left"];
    expect(meets(["P-1 · walk", 7.5], columns, "walk gps>7")).toBe(true);
    expect(meets(["P-1 · walk", 7.5], columns, "gps<=7")).toBe(false);
    expect(meets(["P-1 · walk", null], columns, "gps<=7")).toBe(false);
    expect(meets(["P-1 · walk", 7.5], columns, "speed>0")).toBe(false);
  });

  it("quotes what would break a csv file", () => {
    expect([csvCell('a "b", c'), csvCell(1.5), csvCell(null)]).toEqual(['"a ""b"", c"', "1.5", ""]);
  });
});
