import { useEffect, useMemo, useState, type ReactNode } from "react";
import { flushSync } from "react-dom";
import { Badge, createTheme, MantineProvider, mergeThemeOverrides, Modal, NumberInput } from "@mantine/core";
import { QueryClient, QueryClientProvider } from "@tanstack/react-query";
import { Problem } from "../api/client";
import { SessionProvider } from "../account/Account";
import { I18nProvider, useI18n } from "../i18n/I18n";
import { Pages } from "./Pages";

const theme = createTheme({
  primaryColor: "cyan",
  primaryShade: { light: 9, dark: 9 },
  fontFamily: "system-ui, -apple-system, 'Segoe UI', Roboto, sans-serif",
  defaultRadius: "md",
  // Capitals are hard to read in German, whose nouns have their own.
  components: {
    Badge: Badge.extend({ styles: { label: { textTransform: "none" } } }),
    // A dialog's header is none of the page's landmarks.
    Modal: Modal.extend({ defaultProps: { attributes: { header: { role: "presentation" } } } }),
  },
});

const queries = new QueryClient({
  defaultOptions: {
    queries: {
      staleTime: 5_000,
      // A refusal stays a refusal; only a lost connection is worth a second try.
      retry: (count, error) => !(error instanceof Problem) && count < 2,
    },
  },
});

export function App() {
  return (
    <I18nProvider>
      <Themed>
        <QueryClientProvider client={queries}>
          <SessionProvider>
            <Pages />
          </SessionProvider>
        </QueryClientProvider>
      </Themed>
    </I18nProvider>
  );
}

/** True while the page is printed: paper is white whatever the screen is. */
function usePrinting(): boolean {
  const [printing, setPrinting] = useState(false);
  useEffect(() => {
    const media = window.matchMedia("print");
    // At once, as the browser takes the page as it stands when this returns.
    const follow = () => flushSync(() => setPrinting(media.matches));
    media.addEventListener("change", follow);
    return () => media.removeEventListener("change", follow);
  }, []);
  return printing;
}

/** The theme with the language's way to write numbers. */
function Themed({ children }: { children: ReactNode }) {
  const { language } = useI18n();
  const printing = usePrinting();
  const themed = useMemo(() => {
    const defaultProps = { decimalSeparator: language === "de" ? "," : ".", allowedDecimalSeparators: [",", "."] };
    return mergeThemeOverrides(theme, { components: { NumberInput: NumberInput.extend({ defaultProps }) } });
  }, [language]);
  return (
    <MantineProvider theme={themed} defaultColorScheme="auto" {...(printing ? { forceColorScheme: "light" } : {})}>
      {children}
    </MantineProvider>
  );
}
