/** One's own account: password and second factor. */
import { useState } from "react";
import { Badge, Button, Code, Group, Paper, Stack, Text, TextInput, Title } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { renderSVG } from "uqr";
import { client, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { FormEnd } from "../app/FormEnd";
import { Preferences } from "../app/Preferences";
import { submitting } from "../app/submitting";
import { useI18n } from "../i18n/I18n";
import { ACCOUNT_KEY, useAccount } from "./Account";
import { PasswordField } from "./PasswordField";

export default function AccountPage() {
  const { t } = useI18n();
  const { session } = useAccount();
  if (!session) return null;
  return (
    <Stack maw={700} mx="auto">
      <Title order={1}>{t("account")}</Title>
      <Text c="dimmed">
        {session.user.login} · {t(`role_${session.user.role}`)}
      </Text>
      <Preferences />
      {session.user.password && <Password />}
      {session.user.password && <SecondFactor on={session.user.second_factor} />}
      {!session.user.password && <Text>{t("noOwnPassword")}</Text>}
    </Stack>
  );
}

function Password() {
  const { t } = useI18n();
  const [before, setBefore] = useState("");
  const [wanted, setWanted] = useState("");
  const change = useMutation({
    mutationFn: () => unwrap(client.PUT("/api/v1/auth/password", { body: { old: before, new: wanted } })),
    onSuccess: () => {
      setBefore("");
      setWanted("");
    },
  });
  return (
    <Paper withBorder p="md" component="form" onSubmit={submitting(change.mutate)}>
      <Stack>
        <Title order={2}>{t("changePassword")}</Title>
        <PasswordField label="presentPassword" value={before} onChange={setBefore} />
        <PasswordField label="newPassword" isNew value={wanted} onChange={setWanted} />
        <FormEnd save={change}>{change.isSuccess && <Text role="status">{t("passwordChanged")}</Text>}</FormEnd>
      </Stack>
    </Paper>
  );
}

function SecondFactor({ on }: { on: boolean }) {
  const { t } = useI18n();
  const queries = useQueryClient();
  const [code, setCode] = useState("");
  const refresh = () => {
    setCode("");
    return queries.invalidateQueries({ queryKey: ACCOUNT_KEY });
  };
  const begin = useMutation({ mutationFn: () => unwrap(client.POST("/api/v1/auth/second-factor")) });
  const confirm = useMutation({
    mutationFn: () => unwrap(client.POST("/api/v1/auth/second-factor/confirm", { body: { code } })),
    onSuccess: refresh,
  });
  const remove = useMutation({
    mutationFn: () => unwrap(client.POST("/api/v1/auth/second-factor/remove", { body: { code } })),
    onSuccess: () => {
      begin.reset();
      return refresh();
    },
  });
  const asksForCode = on || begin.data;
  const decide = on ? remove : confirm;
  return (
    <Paper withBorder p="md">
      <Stack>
        <Group>
          <Title order={2}>{t("secondFactor")}</Title>
          <Badge variant="light" color={on ? "teal" : "gray"}>
            {t(on ? "switchedOn" : "switchedOff")}
          </Badge>
        </Group>
        <Text c="dimmed">{t("secondFactorHint")}</Text>
        {!asksForCode && (
          <Group>
            <Button loading={begin.isPending} onClick={() => begin.mutate()}>
              {t("switchOn")}
            </Button>
          </Group>
        )}
        {!on && begin.data && <Secret secret={begin.data} />}
        {asksForCode && (
          <form onSubmit={submitting(decide.mutate)}>
            <Group align="end">
              <TextInput
                label={t("code")}
                autoComplete="one-time-code"
                inputMode="numeric"
                required
                value={code}
                onChange={(event) => setCode(event.currentTarget.value)}
              />
              <Button type="submit" variant={on ? "default" : "filled"} loading={decide.isPending}>
                {t(on ? "switchOff" : "confirm")}
              </Button>
            </Group>
          </form>
        )}
        <ErrorNote error={begin.error ?? confirm.error ?? remove.error} />
      </Stack>
    </Paper>
  );
}

function Secret({ secret }: { secret: Schemas["SecondFactorSecret"] }) {
  const { t } = useI18n();
  const picture = `data:image/svg+xml;utf8,${encodeURIComponent(renderSVG(secret.uri))}`;
  return (
    <Group align="start">
      <img src={picture} alt={t("qrCode")} width={180} height={180} />
      <div>
        <Text>{t("scanCode")}</Text>
        <Code>{secret.secret}</Code>
      </div>
    </Group>
  );
}
