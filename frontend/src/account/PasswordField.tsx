import { PasswordInput } from "@mantine/core";
import { useI18n, type Key } from "../i18n/I18n";

interface Props {
  label: Key;
  value: string;
  onChange: (password: string) => void;
  /** Chosen here, so that the rules stand beside it; else the one that is known already. */
  isNew?: boolean;
}

export function PasswordField({ label, value, onChange, isNew = false }: Props) {
  const { t } = useI18n();
  return (
    <PasswordInput
      label={t(label)}
      {...(isNew ? { description: t("passwordHint") } : {})}
      autoComplete={isNew ? "new-password" : "current-password"}
      required
      value={value}
      onChange={(event) => onChange(event.currentTarget.value)}
    />
  );
}
