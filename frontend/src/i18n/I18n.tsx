/** German and English; the words are in en.ts and de.ts. */
import { createContext, useContext, useEffect, useMemo, useState, type ReactNode } from "react";
import { de } from "./de";
import { en } from "./en";
import { fill } from "./fill";

export type Language = "en" | "de";
export type Key = keyof typeof en;
export type Translate = (key: Key, values?: Record<string, string | number>) => string;

interface I18n {
  language: Language;
  setLanguage: (language: Language) => void;
  t: Translate;
  number: (value: number | null | undefined, digits?: number) => string;
  date: (iso: string) => string;
  moment: (iso: string) => string;
  /** Words for a name of the API such as "hip_flexion"; the name itself, in words, where there are none. */
  name: (apiName: string) => string;
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
    const made = new Intl.NumberFormat(locale, { minimumFractionDigits: digits, maximumFractionDigits: digits });
    numbers.set(digits, made);
    return made;
  };
  const dates = new Intl.DateTimeFormat(locale, { day: "2-digit", month: "short", year: "numeric" });
  const moments = new Intl.DateTimeFormat(locale, { dateStyle: "medium", timeStyle: "medium" });
  return {
    language,
    setLanguage,
    t: (key, values) => fill(words[key], values),
    number: (value, digits = 1) => (value == null ? "–" : numbersWith(digits).format(value)),
    date: (iso) => dates.format(new Date(iso)),
    moment: (iso) => moments.format(new Date(iso)),
    name: (apiName) => {
      if (apiName.startsWith("gvs_")) return `GVS ${words[`n_${apiName.slice(4)}` as Key] ?? apiName}`;
      const known = words[`n_${apiName}` as Key] as string | undefined;
      const plain = apiName.replaceAll("_", " ");
      return known ?? plain.charAt(0).toUpperCase() + plain.slice(1);
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
