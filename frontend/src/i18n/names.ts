/** Words for names of the API, some of them put together: sides, muscles, limits. */
import type { en } from "./en";
import { fill } from "./fill";

type Words = Readonly<Record<keyof typeof en, string>>;

/** Ends of names, and the text into which the words for the rest are put. */
const ENDS: readonly (readonly [string, keyof typeof en])[] = [
  ["_weight", "weightOf"],
  ["_limit", "strengthOf"],
  ["_peak_nm_per_kg", "peakTorqueOf"],
  ["_min", "atLeast"],
  ["_max", "atMost"],
];

function known(words: Words, apiName: string): string | null {
  const own = (words as Readonly<Record<string, string | undefined>>)[`n_${apiName.replace(/[ -]/g, "_")}`];
  if (own !== undefined) return own;
  if (apiName.startsWith("gvs_")) return `GVS ${nameIn(words, apiName.slice(4))}`;
  const [, side, rest] = /^(left|right)_(.*)$/.exec(apiName) ?? [];
  if (side && rest) {
    const whole = known(words, rest);
    return whole && `${whole}, ${words[`n_${side as "left" | "right"}`].toLowerCase()}`;
  }
  const end = ENDS.find(([suffix]) => apiName.endsWith(suffix));
  const name = end && known(words, apiName.slice(0, -end[0].length));
  return end && name ? fill(words[end[1]], { name }) : null;
}

/** The words; where there are none the name itself, with spaces. */
export function nameIn(words: Words, apiName: string): string {
  const plain = apiName.replaceAll("_", " ");
  return known(words, apiName) ?? plain.charAt(0).toUpperCase() + plain.slice(1);
}
