/** German and English; the words are in en.ts and de.ts. */
import { createContext, useContext, useEffect, useMemo, useState, type ReactNode } from "react";
import { de } from "./de";
import { en } from "./en";
import { fill } from "./fill";
import { nameIn } from "./names";
import { strideIn } from "./stride";

export type Language = "en" | "de";
export type Key = keyof typeof en;
export type Translate = (key: Key, values?: Record<string, string | number>) => string;

interface I18n {
  language: Language;
  setLanguage: (language: Language) => void;
  t: Translate;
  number: (value: number | null | undefined, digits?: number) => string;
  /** A small number by its power of ten, such as 3.2e-4. */
  small: (value: number | null | undefined) => string;
  /** Any number with as many digits as it needs. */
  plain: (value: number) => string;
  unit: (apiUnit: string) => string;
  date: (iso: string) => string;
  moment: (iso: string) => string;
  /** Words for a name of the API such as "hip_flexion"; the name itself, in words, where there are none. */
  name: (apiName: string) => string;
  /** The same for a stage of a job or a stride, which the server names in words: "weights, left stride at 1.56 s". */
  told: (words: string) => string;
}

const STORED = "gaitlab-language";
const WORDS: Record<Language, Record<Key, string>> = { en, de };
const Context = createContext<I18n | null>(null);

function initialLanguage(): Language {
  const stored = localStorage.getItem(STORED);
  if (stored === "en" || stored === "de") return stored;
  return navigator.language.startsWith("de") ? "de" : "en";
}

function make(language: Language, setLanguage: (language: Language) => void): I18n {
  const words = WORDS[language];
  const locale = language === "de" ? "de-DE" : "en-GB";
  // Made once: a long table asks for thousands of numbers.
  const numbers = new Map<number, Intl.NumberFormat>();
  const numbersWith = (digits: number) => {
    const known = numbers.get(digits);
    if (known) return known;
    const made = new Intl.NumberFormat(locale, {
      minimumFractionDigits: digits,
      maximumFractionDigits: digits,
      signDisplay: "negative",
    });
    numbers.set(digits, made);
    return made;
  };
  const plain = new Intl.NumberFormat(locale, { maximumSignificantDigits: 6, signDisplay: "negative" });
  const dates = new Intl.DateTimeFormat(locale, { day: "2-digit", month: "short", year: "numeric" });
  const moments = new Intl.DateTimeFormat(locale, { dateStyle: "medium", timeStyle: "medium" });
  const t: Translate = (key, values) => fill((values?.count === 1 && words[`${key}_one` as Key]) || words[key], values);
  const number: I18n["number"] = (value, digits = 1) => (value == null ? "–" : numbersWith(digits).format(value));
  const name = (apiName: string) => nameIn(words, apiName);
  return {
    language,
    setLanguage,
    t,
    number,
    small: (value) => value?.toExponential(1).replace(".", language === "de" ? "," : ".") ?? "–",
    plain: (value) => plain.format(value),
    unit: (apiUnit) => words[`unit_${apiUnit}` as Key] ?? apiUnit,
    date: (iso) => dates.format(new Date(iso)),
    moment: (iso) => moments.format(new Date(iso)),
    name,
    told: (text) => {
      const stride = strideIn(text);
      const before = (stride?.before ?? text).replace(/^only (.*)$/, (_, criterion: string) => t("only", { name: name(criterion) }));
      const at = stride && t("strideAt", { side: name(stride.side).toLowerCase(), start: number(stride.start_s, 2) });
      return [before && name(before), at].filter(Boolean).join(", ");
    },
  };
}

export function I18nProvider({ children }: { children: ReactNode }) {
  const [language, choose] = useState(initialLanguage);
  useEffect(() => {
    document.documentElement.lang = language;
    localStorage.setItem(STORED, language);
  }, [language]);
  const value = useMemo(() => make(language, choose), [language]);
  return <Context.Provider value={value}>{children}</Context.Provider>;
}

export function useI18n(): I18n {
  const value = useContext(Context);
  if (!value) throw new Error("useI18n outside of I18nProvider");
  return value;
}
