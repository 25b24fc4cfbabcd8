import { client, unwrap } from "../api/client";

export const USERS = ["users"];

/** All accounts, for `useQuery`. */
export function usersQuery() {
  return {
    queryKey: USERS,
    queryFn: () => unwrap(client.GET("/api/v1/users", { params: { query: { limit: 200 } } })),
  };
}
