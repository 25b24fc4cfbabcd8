/** Single cycles, cut out of the curves over time that stand beside the result. */
import { useQuery } from "@tanstack/react-query";
import { stridesIn } from "./cycle";
import type { ResultDocument, Side } from "./document";
import { readFile, trialFile } from "./files";
import { parseTable, resample, type Table } from "./table";

export type Cycles = Readonly<Record<string, Partial<Record<Side, (number | null)[][]>>>>;

async function table(resultId: string, name: string): Promise<Table | null> {
  const response = await readFile(resultId, name);
  return response && parseTable(await response.text());
}

async function readCycles(resultId: string, document: ResultDocument): Promise<Cycles> {
  const strides = stridesIn(document);
  const trials = [...new Set(strides.map((stride) => stride.trial))];
  const angles: Record<string, Partial<Record<Side, (number | null)[][]>>> = {};
  for (const trial of trials) {
    const read = await table(resultId, trialFile(trials, trial, "angles.csv"));
    if (!read) continue;
    for (const stride of strides.filter((each) => each.trial === trial)) {
      for (const curve of Object.keys(document.kinematics)) {
        const sides = (angles[curve] ??= {});
        (sides[stride.side] ??= []).push(resample(read, `${stride.side}_${curve}`, stride));
      }
    }
  }
  return angles;
}

/** All cycles of the angles; null until they are read, or while they are not wanted. */
export function useCycles(resultId: string, document: ResultDocument, wanted: boolean): Cycles | null {
  const cycles = useQuery({
    queryKey: ["cycles", resultId],
    queryFn: () => readCycles(resultId, document),
    enabled: wanted,
    staleTime: Infinity,
  });
  return wanted ? (cycles.data ?? null) : null;
}
