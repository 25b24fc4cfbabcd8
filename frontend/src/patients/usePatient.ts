import { useQuery } from "@tanstack/react-query";
import { client, unwrap } from "../api/client";

/** One patient; of a result of several patients there is none. */
export function usePatient(id: string | null) {
  return useQuery({
    queryKey: ["patient", id],
    queryFn: () =>
      unwrap(client.GET("/api/v1/patients/{patient_id}", { params: { path: { patient_id: id ?? "" } } })),
    enabled: id !== null,
  });
}
