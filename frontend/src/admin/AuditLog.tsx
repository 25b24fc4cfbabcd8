import { useState } from "react";
import { Group, Pagination, Table, Text, TextInput } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { client, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";

const PER_PAGE = 50;

export function AuditLog() {
  const { t, moment } = useI18n();
  const [action, setAction] = useState("");
  const [kind, setKind] = useState("");
  const [page, setPage] = useState(1);
  const [wanted] = useDebouncedValue({ action, kind }, 250);
  const query = { ...wanted, limit: PER_PAGE, offset: (page - 1) * PER_PAGE };
  const lines = useQuery({
    queryKey: ["audit", query],
    queryFn: () => unwrap(client.GET("/api/v1/audit", { params: { query } })),
    placeholderData: keepPreviousData,
  });
  return (
    <>
      <Group mb="sm">
        <TextInput label={t("action")} value={action} onChange={(event) => setAction(event.currentTarget.value)} />
        <TextInput label={t("object")} value={kind} onChange={(event) => setKind(event.currentTarget.value)} />
      </Group>
      <ErrorNote error={lines.error} />
      {lines.data?.items.length === 0 && <Text c="dimmed">{t("nothingLogged")}</Text>}
      <Table>
        <Table.Thead>
          <Table.Tr>
            <Table.Th>{t("time")}</Table.Th>
            <Table.Th>{t("login")}</Table.Th>
            <Table.Th>{t("action")}</Table.Th>
            <Table.Th>{t("object")}</Table.Th>
            <Table.Th>{t("address")}</Table.Th>
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {lines.data?.items.map((line) => (
            <Table.Tr key={line.id}>
              <Table.Td>{moment(line.at)}</Table.Td>
              <Table.Td>{line.login}</Table.Td>
              <Table.Td>{line.action}</Table.Td>
              <Table.Td>
                {line.kind} {line.object_id.slice(0, 8)}
              </Table.Td>
              <Table.Td>{line.address}</Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
      {lines.data && (
        <Pagination
          value={page}
          onChange={setPage}
          total={Math.max(1, Math.ceil(lines.data.total / PER_PAGE))}
          getControlProps={(control) => ({ "aria-label": t(control === "next" ? "nextPage" : "previousPage") })}
        />
      )}
    </>
  );
}
