import { useState } from "react";
import { Alert, Button, Text, TextInput, Title } from "@mantine/core";
import { useMutation, useQuery } from "@tanstack/react-query";
import { client, Problem, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { Preferences } from "../app/Preferences";
import { useI18n } from "../i18n/I18n";
import { useAccount } from "./Account";
import { CardForm, LoginField } from "./CardForm";
import { PasswordField } from "./PasswordField";

export function SignInPage() {
  const { t } = useI18n();
  const { enter } = useAccount();
  const [login, setLogin] = useState("");
  const [password, setPassword] = useState("");
  const [code, setCode] = useState("");
  const methods = useQuery({ queryKey: ["methods"], queryFn: () => unwrap(client.GET("/api/v1/auth/methods")) });
  const signIn = useMutation({
    mutationFn: () =>
      unwrap(client.POST("/api/v1/auth/sign-in", { body: { login, password, ...(code ? { code } : {}) } })),
    onSuccess: enter,
  });
  const needsCode = signIn.error instanceof Problem && signIn.error.kind.includes("second-factor");
  return (
    <CardForm onSubmit={signIn.mutate}>
      <div>
        <Title order={1}>gaitlab</Title>
        <Text c="dimmed">{t("slogan")}</Text>
      </div>
      {methods.data?.first_account_needed && <Alert color="yellow">{t("firstAccountNeeded")}</Alert>}
      <LoginField value={login} onChange={setLogin} />
      <PasswordField label="password" value={password} onChange={setPassword} />
      {(needsCode || code) && (
        <TextInput
          label={t("code")}
          autoComplete="one-time-code"
          inputMode="numeric"
          value={code}
          onChange={(event) => setCode(event.currentTarget.value)}
        />
      )}
      <ErrorNote error={signIn.error} />
      <Button type="submit" loading={signIn.isPending}>
        {t("signIn")}
      </Button>
      {methods.data?.single_sign_on && (
        <Button component="a" href="/api/v1/auth/oidc/start" variant="default">
          {methods.data.single_sign_on}
        </Button>
      )}
      <Preferences />
    </CardForm>
  );
}
