/** All results that one may compare, with the names of their patients. */
import { useMemo } from "react";
import { useQuery } from "@tanstack/react-query";
import { client, unwrap, type Schemas } from "../api/client";

export type Result = Schemas["Result"];

const PER_REQUEST = 200;
/** As many as a comparison takes. */
const MOST = 2000;

interface Page<T> {
  items: readonly T[];
  total: number;
}

async function everything<T>(ask: (offset: number) => Promise<Page<T>>): Promise<T[]> {
  const all: T[] = [];
  for (let total = 1; all.length < Math.min(total, MOST); ) {
    const page = await ask(all.length);
    total = page.items.length ? page.total : 0;
    all.push(...page.items);
  }
  return all;
}

export interface Named {
  result: Result;
  pseudonym: string;
}

/** Results of analyses, newest first, with pseudonyms. */
export function useAnalysed() {
  const results = useQuery({
    queryKey: ["results", "everything"],
    queryFn: () =>
      everything((offset) =>
        unwrap(client.GET("/api/v1/results", { params: { query: { limit: PER_REQUEST, offset } } })),
      ),
  });
  const patients = useQuery({
    queryKey: ["patients", "everything"],
    queryFn: () =>
      everything((offset) =>
        unwrap(client.GET("/api/v1/patients", { params: { query: { limit: PER_REQUEST, offset } } })),
      ),
  });
  const named = useMemo(() => {
    const pseudonyms = new Map(patients.data?.map((each) => [each.id, each.pseudonym]));
    return results.data
      ?.filter(({ kind }) => kind === "analyse" || kind === "predict")
      .map((result): Named => ({ result, pseudonym: pseudonyms.get(result.patient_id ?? "") ?? "" }));
  }, [results.data, patients.data]);
  return { named, error: results.error ?? patients.error };
}
