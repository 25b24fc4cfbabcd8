import { Badge, createTheme, MantineProvider, Modal } from "@mantine/core";
import { QueryClient, QueryClientProvider } from "@tanstack/react-query";
import { Problem } from "../api/client";
import { SessionProvider } from "../account/Account";
import { I18nProvider } from "../i18n/I18n";
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
    <MantineProvider theme={theme} defaultColorScheme="auto">
      <I18nProvider>
        <QueryClientProvider client={queries}>
          <SessionProvider>
            <Pages />
          </SessionProvider>
        </QueryClientProvider>
      </I18nProvider>
    </MantineProvider>
  );
}
