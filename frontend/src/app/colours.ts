/** Colours of the curves; the same as in the report, lighter on a dark page. */
import { useMemo } from "react";
import { useComputedColorScheme } from "@mantine/core";
import { useLocalStorage } from "@mantine/hooks";

export const PALETTES = ["standard", "green", "safe"] as const;
export type Palette = (typeof PALETTES)[number];

export interface Colours {
  left: string;
  right: string;
  text: string;
  grid: string;
  band: string;
  cursor: string;
  /** One after the other for the criteria of the weights. */
  criteria: readonly string[];
}

const SIDES: Record<"light" | "dark", Record<Palette, { left: string; right: string }>> = {
  light: {
    standard: { left: "#c8281e", right: "#1d5fae" },
    green: { left: "#c8281e", right: "#1e7b34" },
    safe: { left: "#c45500", right: "#002b5c" },
  },
  dark: {
    standard: { left: "#ff8a80", right: "#82b5f5" },
    green: { left: "#ff8a80", right: "#7fd492" },
    safe: { left: "#ffa94d", right: "#b5cdf0" },
  },
};
const CRITERIA = {
  light: ["#1b7f79", "#d08a1c", "#7a5195", "#7d8f2b", "#8c564b", "#5a7d9a", "#b5739d", "#8a8a8a"],
  dark: ["#3fb3ab", "#e0a13a", "#b58ad0", "#a9bd4a", "#c98d80", "#86aecd", "#d79bc2", "#b0b0b0"],
};
const PAGE = {
  light: { text: "#3d4752", grid: "#e3e7eb", band: "#7f8a9640", cursor: "#111" },
  dark: { text: "#c1c8cf", grid: "#3b4048", band: "#aab4be40", cursor: "#fff" },
};

/** The chosen palette, kept in this browser. */
export function usePalette(): [Palette, (palette: Palette) => void] {
  const [palette, setPalette] = useLocalStorage<Palette>({ key: "gaitlab-palette", defaultValue: "standard" });
  return [palette, setPalette];
}

export function useColours(): Colours {
  const scheme = useComputedColorScheme("light");
  const [palette] = usePalette();
  return useMemo(() => ({ ...PAGE[scheme], ...SIDES[scheme][palette], criteria: CRITERIA[scheme] }), [scheme, palette]);
}

/** Colour of a criterion by its place; after the last the first comes again. */
export function criterionColour({ criteria }: Colours, index: number): string {
  return criteria[index % criteria.length] ?? "gray";
}
