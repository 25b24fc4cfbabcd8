import { useState } from "react";
import { Button, Group, NativeSelect, Pagination, Table, Text, TextInput } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { client, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { auditQuery, EVERYTHING, type Wanted } from "./auditQuery";
import { usersQuery } from "./usersQuery";

const PER_PAGE = 50;

export function AuditLog() {
  const { t } = useI18n();
  const [wanted, setWanted] = useState(EVERYTHING);
  const [page, setPage] = useState(1);
  const [settled] = useDebouncedValue(wanted, 250);
  const query = { ...auditQuery(settled), limit: PER_PAGE, offset: (page - 1) * PER_PAGE };
  const lines = useQuery({
    queryKey: ["audit", query],
    queryFn: () => unwrap(client.GET("/api/v1/audit", { params: { query } })),
    placeholderData: keepPreviousData,
  });
  const change = (part: Partial<Wanted>) => {
    setWanted({ ...wanted, ...part });
    setPage(1);
  };
  return (
    <>
      <Filters wanted={wanted} onChange={change} />
      <ErrorNote error={lines.error} />
      {lines.data?.items.length === 0 && <Text c="dimmed">{t("nothingLogged")}</Text>}
      <Lines lines={lines.data?.items ?? []} onPatient={(patient_id) => change({ patient_id })} />
      {lines.data && (
        <Pagination
          mt="md"
          value={page}
          onChange={setPage}
          total={Math.max(1, Math.ceil(lines.data.total / PER_PAGE))}
          getControlProps={(control) => ({ "aria-label": t(control === "next" ? "nextPage" : "previousPage") })}
        />
      )}
    </>
  );
}

function Filters({ wanted, onChange }: { wanted: Wanted; onChange: (part: Partial<Wanted>) => void }) {
  const { t } = useI18n();
  const users = useQuery(usersQuery());
  const typed = (key: keyof Wanted, label: string, type = "text") => (
    <TextInput
      label={label}
      type={type}
      w={150}
      value={wanted[key]}
      onChange={(event) => onChange({ [key]: event.currentTarget.value })}
    />
  );
  return (
    <Group mb="sm" align="end">
      <NativeSelect
        label={t("account")}
        value={wanted.user_id}
        onChange={(event) => onChange({ user_id: event.currentTarget.value })}
        data={[
          { value: "", label: t("all") },
          ...(users.data?.items ?? []).map(({ id, login }) => ({ value: id, label: login })),
        ]}
      />
      {typed("action", t("action"))}
      {typed("kind", t("object"))}
      {typed("from", t("fromDay"), "date")}
      {typed("to", t("toDay"), "date")}
      {wanted.patient_id && (
        <Button variant="default" onClick={() => onChange({ patient_id: "" })}>
          {t("allPatients")}
        </Button>
      )}
    </Group>
  );
}

interface LinesProps {
  lines: readonly Schemas["AuditLine"][];
  onPatient: (id: string) => void;
}

function Lines({ lines, onPatient }: LinesProps) {
  const { t, moment } = useI18n();
  return (
    <Table>
      <Table.Thead>
        <Table.Tr>
          <Table.Th>{t("time")}</Table.Th>
          <Table.Th>{t("login")}</Table.Th>
          <Table.Th>{t("action")}</Table.Th>
          <Table.Th>{t("object")}</Table.Th>
          <Table.Th>{t("patient")}</Table.Th>
          <Table.Th>{t("address")}</Table.Th>
        </Table.Tr>
      </Table.Thead>
      <Table.Tbody>
        {lines.map(({ id, at, login, action, kind, object_id, patient_id, address }) => (
          <Table.Tr key={id}>
            <Table.Td>{moment(at)}</Table.Td>
            <Table.Td>{login}</Table.Td>
            <Table.Td>{action}</Table.Td>
            <Table.Td>
              {kind} {object_id.slice(0, 8)}
            </Table.Td>
            <Table.Td>
              {patient_id && (
                <Button size="compact-xs" variant="default" onClick={() => onPatient(patient_id)}>
                  <span className="unseen">{t("onlyPatient")} </span>
                  {patient_id.slice(0, 8)}
                </Button>
              )}
            </Table.Td>
            <Table.Td>{address}</Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}
