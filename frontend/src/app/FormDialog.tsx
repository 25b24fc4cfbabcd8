/** A dialog with fields, what went wrong, and a button that saves. */
import type { ReactNode } from "react";
import { Modal, Stack } from "@mantine/core";
import { useI18n } from "../i18n/I18n";
import { FormEnd, type Saving } from "./FormEnd";
import { submitting } from "./submitting";

interface Props {
  title: string;
  opened: boolean;
  onClose: () => void;
  save: Saving;
  children: ReactNode;
}

export function FormDialog({ title, opened, onClose, save, children }: Props) {
  const { t } = useI18n();
  return (
    <Modal opened={opened} onClose={onClose} title={title} closeButtonProps={{ "aria-label": t("close") }}>
      <form onSubmit={submitting(save.mutate)}>
        <Stack>
          {children}
          <FormEnd save={save} />
        </Stack>
      </form>
    </Modal>
  );
}
