/** Who is signed in. */
import { createContext, useContext, useEffect, type ReactNode } from "react";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { client, Problem, setCsrfToken, unwrap, type Schemas } from "../api/client";

type SignedIn = Schemas["SignedIn"];

interface Account {
  session: SignedIn | null;
  loading: boolean;
  may: (permission: Schemas["Permission"]) => boolean;
  enter: (session: SignedIn) => void;
  signOut: () => Promise<void>;
}

export const ACCOUNT_KEY = ["account"];
const Context = createContext<Account | null>(null);

async function currentSession(): Promise<SignedIn | null> {
  try {
    return await unwrap(client.GET("/api/v1/auth/session"));
  } catch (error) {
    if (error instanceof Problem && error.status === 401) return null;
    throw error;
  }
}

export function SessionProvider({ children }: { children: ReactNode }) {
  const queries = useQueryClient();
  const { data, isPending } = useQuery({ queryKey: ACCOUNT_KEY, queryFn: currentSession, refetchInterval: 60_000 });
  const session = data ?? null;
  setCsrfToken(session?.csrf_token ?? "");

  useEffect(() => {
    // A refused request tells that the session has ended elsewhere.
    return queries.getQueryCache().subscribe(({ query }) => {
      const { error } = query.state;
      if (error instanceof Problem && error.status === 401 && query.queryKey[0] !== ACCOUNT_KEY[0]) {
        queries.setQueryData(ACCOUNT_KEY, null);
      }
    });
  }, [queries]);

  const account: Account = {
    session,
    loading: isPending,
    may: (permission) => session?.permissions.includes(permission) ?? false,
    enter: (entered) => {
      setCsrfToken(entered.csrf_token);
      queries.setQueryData(ACCOUNT_KEY, entered);
    },
    signOut: async () => {
      await unwrap(client.POST("/api/v1/auth/sign-out"));
      queries.removeQueries({ predicate: ({ queryKey }) => queryKey[0] !== ACCOUNT_KEY[0] });
      queries.setQueryData(ACCOUNT_KEY, null);
    },
  };
  return <Context.Provider value={account}>{children}</Context.Provider>;
}

export function useAccount(): Account {
  const account = useContext(Context);
  if (!account) throw new Error("useAccount outside of SessionProvider");
  return account;
}
