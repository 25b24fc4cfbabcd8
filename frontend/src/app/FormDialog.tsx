/** A dialog with fields, what went wrong, and a button that saves. */
import type { ReactNode } from "react";
import { Button, Group, Modal, Stack } from "@mantine/core";
import { useI18n } from "../i18n/I18n";
import { ErrorNote } from "./ErrorNote";
import { submitting } from "./submitting";

interface Props {
  title: string;
  opened: boolean;
  onClose: () => void;
  /** What saving does, and how it stands. */
  save: { mutate: () => void; error: unknown; isPending: boolean };
  children: ReactNode;
}

export function FormDialog({ title, opened, onClose, save, children }: Props) {
  const { t } = useI18n();
  return (
    <Modal opened={opened} onClose={onClose} title={title} closeButtonProps={{ "aria-label": t("close") }}>
      <form onSubmit={submitting(save.mutate)}>
        <Stack>
          {children}
          <ErrorNote error={save.error} />
          <Group justify="end">
            <Button type="submit" loading={save.isPending}>
              {t("save")}
            </Button>
          </Group>
        </Stack>
      </form>
    </Modal>
  );
}
