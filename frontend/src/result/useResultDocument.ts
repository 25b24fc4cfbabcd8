/** The document of a result; it never changes. */
import { useQuery } from "@tanstack/react-query";
import { client, unwrap } from "../api/client";
import type { ResultDocument } from "./document";

export function documentQuery(id: string) {
  return {
    queryKey: ["document", id],
    queryFn: () =>
      unwrap(client.GET("/api/v1/results/{result_id}/document", { params: { path: { result_id: id } } })).then(
        (told) => told as unknown as ResultDocument,
      ),
    staleTime: Infinity,
  };
}

export function useResultDocument(id: string) {
  return useQuery(documentQuery(id));
}
