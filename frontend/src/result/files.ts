/** Files of a result. */
import { problemOf } from "../api/client";

/** Address of one file; names of files hold slashes that the route wants as they are. */
export function fileUrl(resultId: string, name: string): string {
  return `/api/v1/results/${resultId}/files/${name.split("/").map(encodeURIComponent).join("/")}`;
}

/** One file; null where the result has none of this name. */
export async function readFile(resultId: string, name: string): Promise<Response | null> {
  const response = await fetch(fileUrl(resultId, name));
  if (response.status === 404) return null;
  if (!response.ok) throw problemOf(await response.json().catch(() => null), response.status);
  return response;
}

/** Name of a trial's file: a single recording has no folder of its own. */
export function trialFile(trials: readonly string[], trial: string, name: string): string {
  return trials.length > 1 ? `${trial}/${name}` : name;
}
