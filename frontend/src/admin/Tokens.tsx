import { useState } from "react";
import { Alert, Button, Code, Group, Table, Text, TextInput } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useAccount } from "../account/Account";
import { client, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { submitting } from "../app/submitting";
import { useI18n } from "../i18n/I18n";

const KEY = ["tokens"];

export function Tokens() {
  const { t, date } = useI18n();
  const { session } = useAccount();
  const queries = useQueryClient();
  const [name, setName] = useState("");
  const refresh = () => queries.invalidateQueries({ queryKey: KEY });
  const tokens = useQuery({ queryKey: KEY, queryFn: () => unwrap(client.GET("/api/v1/tokens")) });
  const create = useMutation({
    mutationFn: () =>
      unwrap(
        client.POST("/api/v1/tokens", {
          // A program may read; what changes data is for people.
          body: { name, scopes: (session?.permissions ?? []).filter((each) => each.endsWith(":read")) },
        }),
      ),
    onSuccess: () => {
      setName("");
      return refresh();
    },
  });
  const revoke = useMutation({
    mutationFn: (id: string) => unwrap(client.DELETE("/api/v1/tokens/{token_id}", { params: { path: { token_id: id } } })),
    onSuccess: refresh,
  });
  return (
    <>
      <form onSubmit={submitting(create.mutate)}>
        <Group align="end">
          <TextInput
            label={t("tokenName")}
            description={t("tokenHint")}
            required
            value={name}
            onChange={(event) => setName(event.currentTarget.value)}
          />
          <Button type="submit" loading={create.isPending}>
            {t("makeToken")}
          </Button>
        </Group>
      </form>
      {create.data && (
        <Alert my="sm" title={t("shownOnce")}>
          <Code>{create.data.text}</Code>
        </Alert>
      )}
      <ErrorNote error={tokens.error ?? create.error ?? revoke.error} />
      {tokens.data?.length === 0 && <Text c="dimmed">{t("noTokens")}</Text>}
      <Table mt="md">
        <Table.Thead>
          <Table.Tr>
            <Table.Th>{t("tokenName")}</Table.Th>
            <Table.Th>{t("expires")}</Table.Th>
            <Table.Th>
              <span className="unseen">{t("revoke")}</span>
            </Table.Th>
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {tokens.data?.map((token) => (
            <Table.Tr key={token.id}>
              <Table.Td>{token.name}</Table.Td>
              <Table.Td>{token.expires_at ? t("until", { date: date(token.expires_at) }) : "–"}</Table.Td>
              <Table.Td>
                {token.revoked_at ? (
                  t("revoked")
                ) : (
                  <Button size="xs" variant="default" onClick={() => revoke.mutate(token.id)}>
                    {t("revoke")}
                    <span className="unseen"> {token.name}</span>
                  </Button>
                )}
              </Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </>
  );
}
