/** Forms of people who are not signed in: a card in the middle of the page. */
import type { ReactNode } from "react";
import { Center, Paper, Stack, TextInput } from "@mantine/core";
import { submitting } from "../app/submitting";
import { useI18n } from "../i18n/I18n";

export function CardForm({ onSubmit, children }: { onSubmit: () => void; children: ReactNode }) {
  return (
    <Center component="main" mih="100vh" p="md">
      <Paper withBorder shadow="sm" p="xl" w="100%" maw={420}>
        <form onSubmit={submitting(onSubmit)}>
          <Stack>{children}</Stack>
        </form>
      </Paper>
    </Center>
  );
}

export function LoginField({ value, onChange }: { value: string; onChange: (login: string) => void }) {
  const { t } = useI18n();
  return (
    <TextInput
      label={t("login")}
      autoComplete="username"
      required
      value={value}
      onChange={(event) => onChange(event.currentTarget.value)}
    />
  );
}
