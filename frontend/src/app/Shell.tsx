import type { MouseEvent, ReactNode } from "react";
import { Anchor, AppShell, Box, Button, Group, Text } from "@mantine/core";
import { Link, useLocation } from "wouter";
import { useAccount } from "../account/Account";
import { useI18n, type Key } from "../i18n/I18n";
import { Preferences } from "./Preferences";

const PLACES: { path: string; label: Key; needs: "patients:read" | "analyses:read" | "results:read" | "system:read" }[] = [
  { path: "/patients", label: "patients", needs: "patients:read" },
  { path: "/compare", label: "compare", needs: "results:read" },
  { path: "/jobs", label: "jobs", needs: "analyses:read" },
  { path: "/admin", label: "admin", needs: "system:read" },
];

const MAIN = "main";

/** Move the keyboard behind the menu; the address stays, as it names a page. */
function skip(event: MouseEvent): void {
  event.preventDefault();
  document.getElementById(MAIN)?.focus();
}

export function Shell({ children }: { children: ReactNode }) {
  const { t } = useI18n();
  const { session, may, signOut } = useAccount();
  const [location] = useLocation();
  return (
    <AppShell header={{ height: 56 }} padding="md">
      <a className="skip" href="#main" onClick={skip}>
        {t("skipMenu")}
      </a>
      <AppShell.Header>
        <Group h="100%" px="md" justify="space-between" wrap="nowrap">
          <Group gap="lg" wrap="nowrap" component="nav" aria-label={t("mainMenu")}>
            <Text fw={700} size="lg">
              gaitlab
            </Text>
            {PLACES.filter((place) => may(place.needs)).map((place) => (
              <Anchor
                key={place.path}
                component={Link}
                href={place.path}
                aria-current={location.startsWith(place.path) ? "page" : undefined}
                fw={location.startsWith(place.path) ? 700 : 400}
                c="var(--mantine-color-text)"
              >
                {t(place.label)}
              </Anchor>
            ))}
          </Group>
          <Group gap="sm" wrap="nowrap">
            <Box visibleFrom="md">
              <Preferences />
            </Box>
            <Anchor component={Link} href="/account" size="sm" visibleFrom="sm" c="var(--mantine-color-text)">
              {session?.user.display_name || session?.user.login}
            </Anchor>
            <Button size="xs" variant="default" onClick={() => void signOut()}>
              {t("signOut")}
            </Button>
          </Group>
        </Group>
      </AppShell.Header>
      <AppShell.Main id={MAIN} tabIndex={-1}>{children}</AppShell.Main>
    </AppShell>
  );
}
