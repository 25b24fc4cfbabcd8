import { Stack, Tabs, Title } from "@mantine/core";
import { useI18n } from "../i18n/I18n";
import { AuditLog } from "./AuditLog";
import { SystemState } from "./SystemState";
import { Tokens } from "./Tokens";
import { Users } from "./Users";

export default function AdminPage() {
  const { t } = useI18n();
  return (
    <Stack maw={1200} mx="auto">
      <Title order={1}>{t("admin")}</Title>
      <Tabs defaultValue="users" keepMounted={false}>
        <Tabs.List>
          <Tabs.Tab value="users">{t("users")}</Tabs.Tab>
          <Tabs.Tab value="tokens">{t("tokens")}</Tabs.Tab>
          <Tabs.Tab value="audit">{t("auditLog")}</Tabs.Tab>
          <Tabs.Tab value="system">{t("system")}</Tabs.Tab>
        </Tabs.List>
        <Tabs.Panel value="users" pt="md">
          <Users />
        </Tabs.Panel>
        <Tabs.Panel value="tokens" pt="md">
          <Tokens />
        </Tabs.Panel>
        <Tabs.Panel value="audit" pt="md">
          <AuditLog />
        </Tabs.Panel>
        <Tabs.Panel value="system" pt="md">
          <SystemState />
        </Tabs.Panel>
      </Tabs>
    </Stack>
  );
}
