/** A one-time link: the first account, an invitation, or a new password. */
import { useState } from "react";
import { Button, Text, TextInput, Title } from "@mantine/core";
import { useMutation, useQuery } from "@tanstack/react-query";
import { useLocation } from "wouter";
import { client, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { useAccount } from "./Account";
import { CardForm, LoginField } from "./CardForm";
import { PasswordField } from "./PasswordField";

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
  return (
    <CardForm onSubmit={accept.mutate}>
      <Title order={1}>{isNew ? t("makeAccount") : t("choosePassword")}</Title>
      <ErrorNote error={purpose.error} />
      {purpose.data?.login && <Text>{purpose.data.login}</Text>}
      {isNew && (
        <>
          <LoginField value={login} onChange={setLogin} />
          <TextInput
            label={t("displayName")}
            autoComplete="name"
            value={name}
            onChange={(event) => setName(event.currentTarget.value)}
          />
        </>
      )}
      <PasswordField label="password" isNew value={password} onChange={setPassword} />
      <ErrorNote error={accept.error} />
      <Button type="submit" loading={accept.isPending} disabled={!purpose.data}>
        {t("goOn")}
      </Button>
    </CardForm>
  );
}
