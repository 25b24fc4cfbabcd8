/** Single cycles, cut out of the curves over time that stand beside the result. */
import { useQuery } from "@tanstack/react-query";
import { stridesIn } from "./cycle";
import type { ResultDocument, Side, Stride } from "./document";
import { readFile, trialFile } from "./files";
import { parseTable, resample, type Table } from "./table";

export type Cycles = Readonly<Record<string, Partial<Record<Side, (number | null)[][]>>>>;

async function table(resultId: string, name: string): Promise<Table | null> {
  const response = await readFile(resultId, name);
  return response && parseTable(await response.text());
}

type Collected = Record<string, Partial<Record<Side, (number | null)[][]>>>;

interface Source {
  name: string;
  curves: readonly string[];
  /** A stride that misses the plate for a moment has no forces at all. */
  whole: boolean;
}

/** Cut the strides of one table into cycles. */
function cut(found: Collected, read: Table, strides: readonly Stride[], { curves, whole }: Source): void {
  for (const stride of strides) {
    for (const curve of curves) {
      const cycle = resample(read, `${stride.side}_${curve}`, stride);
      if (whole && cycle.includes(null)) continue;
      const sides = (found[curve] ??= {});
      (sides[stride.side] ??= []).push(cycle);
    }
  }
}

async function readCycles(resultId: string, document: ResultDocument): Promise<Cycles> {
  const strides = stridesIn(document);
  const trials = [...new Set(strides.map((stride) => stride.trial))];
  const tables: Source[] = [
    { name: "angles.csv", curves: Object.keys(document.kinematics), whole: false },
    { name: "kinetics.csv", curves: Object.keys(document.kinetics?.curves ?? {}), whole: true },
  ].filter(({ curves }) => curves.length > 0);
  const found: Collected = {};
  for (const trial of trials) {
    const own = strides.filter((each) => each.trial === trial);
    for (const source of tables) {
      const read = await table(resultId, trialFile(trials, trial, source.name));
      if (read) cut(found, read, own, source);
    }
  }
  return found;
}

/** All cycles of angles and kinetics; null until they are read, or while they are not wanted. */
export function useCycles(resultId: string, document: ResultDocument, wanted: boolean): Cycles | null {
  const cycles = useQuery({
    queryKey: ["cycles", resultId],
    queryFn: () => readCycles(resultId, document),
    enabled: wanted,
    staleTime: Infinity,
  });
  return wanted ? (cycles.data ?? null) : null;
}
