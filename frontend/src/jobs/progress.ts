/** What a running job has told so far. */
import type { Schemas } from "../api/client";

export type Job = Schemas["Job"];
export type Told = Schemas["Progress"] & { status?: Job["status"] };

export interface History {
  told: Told;
  /** Iterations of the present stage and trial, and their residuals. */
  iterations: readonly number[];
  residuals: readonly number[];
}

export const NOTHING: History = { told: {}, iterations: [], residuals: [] };

/** The history with one more report; a new stage or trial begins a new curve. */
export function advance(history: History, told: Told): History {
  const sameStage = told.stage === history.told.stage && told.trial === history.told.trial;
  const before = sameStage ? history : NOTHING;
  const { iteration, residual } = told;
  if (iteration == null || residual == null || residual <= 0) return { ...before, told };
  const last = before.iterations.at(-1) ?? -1;
  // The solver began anew.
  const kept = iteration > last ? before : NOTHING;
  return { told, iterations: [...kept.iterations, iteration], residuals: [...kept.residuals, residual] };
}

/** Seconds that the stage still takes if it goes on as so far; null where that is unknown. */
export function secondsLeft(told: Told): number | null {
  const { done, seconds } = told;
  if (done == null || seconds == null || done <= 0.02 || done >= 1) return null;
  return (seconds / done) * (1 - done);
}
