import { client, unwrap } from "../api/client";

/** A visit by its id, for `useQuery`. */
export function visitQuery(id: string) {
  return {
    queryKey: ["visit", id],
    queryFn: () => unwrap(client.GET("/api/v1/sessions/{session_id}", { params: { path: { session_id: id } } })),
  };
}
