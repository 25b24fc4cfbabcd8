/** The typed client: every path, parameter and answer comes from openapi.json. */
import createClient, { type Middleware } from "openapi-fetch";
import type { components, paths } from "./schema";

export type Schemas = components["schemas"];

/** What the server says when it refuses. */
export class Problem extends Error {
  constructor(
    readonly status: number,
    message: string,
    readonly kind: string,
  ) {
    super(message);
  }
}

let csrf = "";

/** Remember the token that every change must carry. */
export function setCsrfToken(token: string): void {
  csrf = token;
}

/** Headers that a request outside the typed client needs. */
export function changeHeaders(): Record<string, string> {
  return { "X-CSRF-Token": csrf };
}

const protectChanges: Middleware = {
  onRequest({ request }) {
    if (request.method !== "GET") request.headers.set("X-CSRF-Token", csrf);
    return request;
  },
};

export const client = createClient<paths>({ baseUrl: "/" });
client.use(protectChanges);

interface Answer<T> {
  data?: T | undefined;
  error?: unknown;
  response: Response;
}

/** Words of a problem document, with those of single fields. */
export function problemOf(error: unknown, status: number): Problem {
  const told = (error ?? {}) as { detail?: string; title?: string; type?: string; errors?: { message?: string }[] };
  const fields = (told.errors ?? []).map((each) => Object.values(each).join(": "));
  const words = [told.detail ?? told.title ?? `HTTP ${status}`, ...fields].join("\n");
  return new Problem(status, words, told.type ?? "");
}

/** The data of an answer; a refusal is thrown as a Problem. */
export async function unwrap<T>(answer: Promise<Answer<T>>): Promise<T> {
  const { data, error, response } = await answer;
  if (!response.ok) throw problemOf(error, response.status);
  return data as T;
}

/** Value of If-Match for an object that was read. */
export function ifMatch(version: number): { "if-match": string } {
  return { "if-match": `"${version}"` };
}
