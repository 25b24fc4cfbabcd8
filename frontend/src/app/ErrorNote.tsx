import { Alert } from "@mantine/core";
import { useI18n } from "../i18n/I18n";

/** A refusal in the words of the server. */
export function ErrorNote({ error }: { error: unknown }) {
  const { t } = useI18n();
  if (!error) return null;
  const words = error instanceof Error ? error.message : String(error);
  return (
    <Alert color="red" role="alert" title={t("problem")} style={{ whiteSpace: "pre-line" }}>
      {words}
    </Alert>
  );
}
