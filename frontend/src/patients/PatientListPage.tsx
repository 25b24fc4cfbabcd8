import { useState } from "react";
import { Anchor, Button, Group, NativeSelect, Pagination, Stack, Table, Text, TextInput, Title } from "@mantine/core";
import { useDebouncedValue, useDisclosure } from "@mantine/hooks";
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { Link } from "wouter";
import { useAccount } from "../account/Account";
import { client, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { NewPatientForm } from "./NewPatientForm";

const PER_PAGE = 25;
const ORDERS = ["pseudonym", "-last_visit", "-created_at"] as const;
type Order = (typeof ORDERS)[number];

export function PatientListPage() {
  const { t } = useI18n();
  const { may } = useAccount();
  const [search, setSearch] = useState("");
  const [order, setOrder] = useState<Order>("pseudonym");
  const [page, setPage] = useState(1);
  const [adding, form] = useDisclosure();
  const [wanted] = useDebouncedValue(search, 250);
  const query = { search: wanted, order, limit: PER_PAGE, offset: (page - 1) * PER_PAGE };
  const patients = useQuery({
    queryKey: ["patients", query],
    queryFn: () => unwrap(client.GET("/api/v1/patients", { params: { query } })),
    placeholderData: keepPreviousData,
  });
  const total = patients.data?.total ?? 0;
  return (
    <Stack maw={1100} mx="auto">
      <Group justify="space-between">
        <Title order={1}>{t("patients")}</Title>
        {may("patients:write") && <Button onClick={form.open}>{t("newPatient")}</Button>}
      </Group>
      <NewPatientForm opened={adding} onClose={form.close} />
      <Group align="end">
        <TextInput
          label={t("search")}
          placeholder={t("searchHint")}
          w={320}
          value={search}
          onChange={(event) => {
            setSearch(event.currentTarget.value);
            setPage(1);
          }}
        />
        <NativeSelect
          label={t("order")}
          value={order}
          onChange={(event) => setOrder(event.currentTarget.value as Order)}
          data={[
            { value: "pseudonym", label: t("pseudonym") },
            { value: "-last_visit", label: t("lastVisit") },
            { value: "-created_at", label: t("newestFirst") },
          ]}
        />
      </Group>
      <ErrorNote error={patients.error} />
      {patients.data && <PatientTable patients={patients.data.items} />}
      {total > PER_PAGE && (
        <Pagination
          value={page}
          onChange={setPage}
          total={Math.ceil(total / PER_PAGE)}
          getControlProps={(control) => ({ "aria-label": t(control === "next" ? "nextPage" : "previousPage") })}
        />
      )}
    </Stack>
  );
}

function PatientTable({ patients }: { patients: readonly Schemas["Patient"][] }) {
  const { t, date } = useI18n();
  if (patients.length === 0) return <Text c="dimmed">{t("noPatients")}</Text>;
  return (
    <Table highlightOnHover>
      <Table.Thead>
        <Table.Tr>
          <Table.Th>{t("pseudonym")}</Table.Th>
          <Table.Th>{t("diagnosis")}</Table.Th>
          <Table.Th>{t("visits")}</Table.Th>
          <Table.Th>{t("lastVisit")}</Table.Th>
        </Table.Tr>
      </Table.Thead>
      <Table.Tbody>
        {patients.map((patient) => (
          <Table.Tr key={patient.id}>
            <Table.Td>
              <Anchor component={Link} href={`/patients/${patient.id}`} fw={600}>
                {patient.pseudonym}
              </Anchor>
            </Table.Td>
            <Table.Td>{patient.diagnosis}</Table.Td>
            <Table.Td>{patient.n_sessions}</Table.Td>
            <Table.Td>{patient.last_visit ? date(patient.last_visit) : "–"}</Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}
