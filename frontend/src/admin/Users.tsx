import { useState } from "react";
import { Alert, Button, Code, Group, NativeSelect, Switch, Table, TextInput } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { client, ifMatch, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { submitting } from "../app/submitting";
import { useI18n, type Key } from "../i18n/I18n";
import { USERS, usersQuery } from "./usersQuery";

type User = Schemas["User"];
type Role = Schemas["Role"];
const ROLES: Role[] = ["admin", "clinician", "researcher", "viewer"];

function useRoleChoices() {
  const { t } = useI18n();
  return ROLES.map((value) => ({ value, label: t(`role_${value}` as Key) }));
}

export function Users() {
  const { t } = useI18n();
  const roles = useRoleChoices();
  const queries = useQueryClient();
  const [link, setLink] = useState("");
  const users = useQuery(usersQuery());
  const change = useMutation({
    mutationFn: ({ user, body }: { user: User; body: Schemas["UserChange"] }) =>
      unwrap(
        client.PATCH("/api/v1/users/{user_id}", {
          params: { path: { user_id: user.id }, header: ifMatch(user.version) },
          body,
        }),
      ),
    onSettled: () => queries.invalidateQueries({ queryKey: USERS }),
  });
  const newPassword = useMutation({
    mutationFn: (id: string) => unwrap(client.POST("/api/v1/users/{user_id}/link", { params: { path: { user_id: id } } })),
    onSuccess: (told) => setLink(told.url),
  });
  return (
    <>
      <Invite onInvited={setLink} />
      {link && (
        <Alert my="sm" title={t("oneTimeLink")}>
          {/* As it is sent to somebody, it needs the server's name, which the server need not know. */}
          <Code>{new URL(link, window.location.href).href}</Code>
        </Alert>
      )}
      <ErrorNote error={users.error ?? change.error ?? newPassword.error} />
      <Table mt="md">
        <Table.Thead>
          <Table.Tr>
            <Table.Th>{t("login")}</Table.Th>
            <Table.Th>{t("displayName")}</Table.Th>
            <Table.Th>{t("role")}</Table.Th>
            <Table.Th>{t("active")}</Table.Th>
            <Table.Th>{t("password")}</Table.Th>
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {users.data?.items.map((user) => (
            <Table.Tr key={user.id}>
              <Table.Td>{user.login}</Table.Td>
              <Table.Td>{user.display_name}</Table.Td>
              <Table.Td>
                <NativeSelect
                  size="xs"
                  aria-label={`${t("role")} ${user.login}`}
                  value={user.role}
                  data={roles}
                  onChange={(event) => change.mutate({ user, body: { role: event.currentTarget.value as Role } })}
                />
              </Table.Td>
              <Table.Td>
                <Switch
                  aria-label={`${t("active")} ${user.login}`}
                  checked={user.active}
                  onChange={(event) => change.mutate({ user, body: { active: event.currentTarget.checked } })}
                />
              </Table.Td>
              <Table.Td>
                <Button size="xs" variant="default" onClick={() => newPassword.mutate(user.id)}>
                  {t("newLink")}
                </Button>
              </Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </>
  );
}

function Invite({ onInvited }: { onInvited: (url: string) => void }) {
  const { t } = useI18n();
  const roles = useRoleChoices();
  const queries = useQueryClient();
  const [login, setLogin] = useState("");
  const [role, setRole] = useState<Role>("clinician");
  const invite = useMutation({
    mutationFn: () => unwrap(client.POST("/api/v1/users", { body: { login, role } })),
    onSuccess: (told) => {
      onInvited(told.link.url);
      setLogin("");
      return queries.invalidateQueries({ queryKey: USERS });
    },
  });
  return (
    <form onSubmit={submitting(invite.mutate)}>
      <Group align="end">
        <TextInput label={t("login")} required value={login} onChange={(event) => setLogin(event.currentTarget.value)} />
        <NativeSelect
          label={t("role")}
          value={role}
          data={roles}
          onChange={(event) => setRole(event.currentTarget.value as Role)}
        />
        <Button type="submit" loading={invite.isPending}>
          {t("invite")}
        </Button>
      </Group>
      <ErrorNote error={invite.error} />
    </form>
  );
}
