/** A one-time link: the first account, an invitation, or a new password. */
import { useState, type FormEvent } from "react";
import { Button, Center, Paper, PasswordInput, Stack, Text, TextInput, Title } from "@mantine/core";
import { useMutation, useQuery } from "@tanstack/react-query";
import { useLocation } from "wouter";
import { client, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { useAccount } from "./Account";

export function LinkPage() {
  const { t } = useI18n();
  const { enter } = useAccount();
  const [, navigate] = useLocation();
  // Behind '#', so that it reaches no log; read once.
  const [token] = useState(() => window.location.hash.slice(1));
  const [login, setLogin] = useState("");
  const [name, setName] = useState("");
  const [password, setPassword] = useState("");
  const purpose = useQuery({
    queryKey: ["link", token],
    queryFn: () => unwrap(client.POST("/api/v1/auth/link", { body: { token } })),
  });
  const isNew = purpose.data?.login === null;
  const accept = useMutation({
    mutationFn: () =>
      unwrap(
        client.POST("/api/v1/auth/link/accept", {
          body: { token, password, display_name: name, login: isNew ? login : null },
        }),
      ),
    onSuccess: (session) => {
      enter(session);
      navigate("/", { replace: true });
    },
  });
  const submit = (event: FormEvent) => {
    event.preventDefault();
    accept.mutate();
  };
  return (
    <Center component="main" mih="100vh" p="md">
      <Paper withBorder shadow="sm" p="xl" w={420}>
        <form onSubmit={submit}>
          <Stack>
            <Title order={1}>{isNew ? t("makeAccount") : t("choosePassword")}</Title>
            <ErrorNote error={purpose.error} />
            {purpose.data?.login && <Text>{purpose.data.login}</Text>}
            {isNew && (
              <>
                <TextInput
                  label={t("login")}
                  autoComplete="username"
                  required
                  value={login}
                  onChange={(event) => setLogin(event.currentTarget.value)}
                />
                <TextInput
                  label={t("displayName")}
                  autoComplete="name"
                  value={name}
                  onChange={(event) => setName(event.currentTarget.value)}
                />
              </>
            )}
            <PasswordInput
              label={t("password")}
              description={t("passwordHint")}
              autoComplete="new-password"
              required
              value={password}
              onChange={(event) => setPassword(event.currentTarget.value)}
            />
            <ErrorNote error={accept.error} />
            <Button type="submit" loading={accept.isPending} disabled={!purpose.data}>
              {t("goOn")}
            </Button>
          </Stack>
        </form>
      </Paper>
    </Center>
  );
}
