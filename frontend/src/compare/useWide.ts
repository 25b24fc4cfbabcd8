/** The numbers of any number of results. */
import { useQuery } from "@tanstack/react-query";
import { client, unwrap, type Schemas } from "../api/client";
import { join, widen, type Wide } from "./wide";

/** Results of one request: what a browser reads without a pause. */
const PER_REQUEST = 50;

async function compare(ids: readonly string[]): Promise<Schemas["Comparison"]> {
  return unwrap(
    client.POST("/api/v1/comparisons", {
      body: { members: ids.map((id) => ({ result_id: id, group: "" })), tables: ["quantities", "weights"] },
    }),
  );
}

async function compareAll(ids: readonly string[]): Promise<{ wide: Wide; problems: string[] }> {
  const parts: Wide[] = [];
  const problems: string[] = [];
  for (let first = 0; first < ids.length; first += PER_REQUEST) {
    const some = ids.slice(first, first + PER_REQUEST);
    const told = await compare(some);
    parts.push(widen(told.tables, some));
    problems.push(...told.problems);
  }
  return { wide: join(parts), problems };
}

export function useWide(ids: readonly string[]) {
  const { data, error } = useQuery({
    queryKey: ["comparison", ids],
    queryFn: () => compareAll(ids),
    staleTime: Infinity,
    // Maps are not compared cell by cell.
    structuralSharing: false,
  });
  return { wide: data?.wide ?? null, problems: data?.problems ?? [], error };
}
