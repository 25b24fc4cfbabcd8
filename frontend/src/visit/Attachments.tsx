/** Videos and documents of a visit. */
import { Anchor, Button, Group, Paper, Text, Title } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useAccount } from "../account/Account";
import { client, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";

/** Those of a visit; only people who may know who the patient is see them. */
export function useAttachments(visitId: string | null) {
  const { may } = useAccount();
  return useQuery({
    queryKey: ["attachments", visitId],
    queryFn: () =>
      unwrap(
        client.GET("/api/v1/sessions/{session_id}/attachments", {
          params: { path: { session_id: visitId ?? "" }, query: { limit: 100 } },
        }),
      ),
    enabled: visitId !== null && may("identities:read"),
  });
}

export function Attachments({ visitId }: { visitId: string }) {
  const { t, number } = useI18n();
  const { may } = useAccount();
  const queries = useQueryClient();
  const attachments = useAttachments(visitId);
  const remove = useMutation({
    mutationFn: (id: string) =>
      unwrap(client.DELETE("/api/v1/attachments/{attachment_id}", { params: { path: { attachment_id: id } } })),
    onSettled: () => queries.invalidateQueries({ queryKey: ["attachments", visitId] }),
  });
  return (
    <>
      <ErrorNote error={attachments.error ?? remove.error} />
      {(attachments.data?.items.length ?? 0) > 0 && <Title order={2}>{t("attachments")}</Title>}
      {attachments.data?.items.map((each) => (
        <Paper withBorder p="sm" key={each.id}>
          <Group justify="space-between">
            <Group>
              <Anchor href={`/api/v1/attachments/${each.id}/file`} fw={600} download>
                {each.name}
              </Anchor>
              <Text size="sm" c="dimmed">
                {each.size < 1e5 ? `${number(each.size / 1e3)} kB` : `${number(each.size / 1e6)} MB`}
              </Text>
            </Group>
            {may("patients:write") && (
              <Button size="xs" variant="default" onClick={() => remove.mutate(each.id)}>
                {t("delete")}
                <span className="unseen"> {each.name}</span>
              </Button>
            )}
          </Group>
        </Paper>
      ))}
    </>
  );
}
