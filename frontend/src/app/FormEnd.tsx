/** The end of a form: what went wrong, further buttons, and the one that saves. */
import type { ReactNode } from "react";
import { Button, Group } from "@mantine/core";
import { useI18n } from "../i18n/I18n";
import { ErrorNote } from "./ErrorNote";

/** What saving does, and how it stands. */
export interface Saving {
  mutate: () => void;
  error: unknown;
  isPending: boolean;
}

export function FormEnd({ save, children }: { save: Omit<Saving, "mutate">; children?: ReactNode }) {
  const { t } = useI18n();
  return (
    <>
      <ErrorNote error={save.error} />
      <Group justify="end">
        {children}
        <Button type="submit" loading={save.isPending}>
          {t("save")}
        </Button>
      </Group>
    </>
  );
}
