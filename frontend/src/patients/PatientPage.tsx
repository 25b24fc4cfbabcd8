import { useState } from "react";
import { Anchor, Badge, Button, Checkbox, Group, Paper, Stack, Text, Timeline, Title } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { useQuery } from "@tanstack/react-query";
import { Link, useLocation } from "wouter";
import { useAccount } from "../account/Account";
import { client, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { NewVisitForm } from "./NewVisitForm";
import { usePatient } from "./usePatient";

type Result = Schemas["Result"];

export function PatientPage({ id }: { id: string }) {
  const { t } = useI18n();
  const { may } = useAccount();
  const [, navigate] = useLocation();
  const [adding, form] = useDisclosure();
  const [chosen, setChosen] = useState<readonly string[]>([]);
  const path = { patient_id: id };
  const patient = usePatient(id);
  const visits = useQuery({
    queryKey: ["visits", id],
    queryFn: () => unwrap(client.GET("/api/v1/patients/{patient_id}/sessions", { params: { path, query: { limit: 100 } } })),
  });
  const results = useQuery({
    queryKey: ["results", { patient_id: id }],
    queryFn: () =>
      unwrap(client.GET("/api/v1/results", { params: { query: { patient_id: id, kind: "analyse", limit: 100 } } })),
  });
  const toggle = (result: string) =>
    setChosen(chosen.includes(result) ? chosen.filter((each) => each !== result) : [...chosen, result]);
  if (!patient.data) return <ErrorNote error={patient.error} />;
  return (
    <Stack maw={1100} mx="auto">
      <Group justify="space-between">
        <div>
          <Anchor component={Link} href="/patients">
            {t("patients")}
          </Anchor>
          <Title order={1}>{patient.data.pseudonym}</Title>
          <Text c="dimmed">{patient.data.diagnosis}</Text>
        </div>
        <Group>
          <Button
            variant="default"
            disabled={chosen.length < 2}
            onClick={() => navigate(`/compare?results=${chosen.join(",")}`)}
          >
            {t("compareChosen", { count: chosen.length })}
          </Button>
          {may("patients:write") && <Button onClick={form.open}>{t("newVisit")}</Button>}
        </Group>
      </Group>
      <NewVisitForm patientId={id} opened={adding} onClose={form.close} />
      <ErrorNote error={visits.error ?? results.error} />
      {visits.data?.items.length === 0 && <Text c="dimmed">{t("noVisits")}</Text>}
      <Timeline bulletSize={18}>
        {visits.data?.items.map((visit) => (
          <Timeline.Item key={visit.id}>
            <Visit
              visit={visit}
              results={(results.data?.items ?? []).filter((each) => each.session_id === visit.id)}
              chosen={chosen}
              onToggle={toggle}
            />
          </Timeline.Item>
        ))}
      </Timeline>
    </Stack>
  );
}

interface VisitProps {
  visit: Schemas["Session"];
  results: readonly Result[];
  chosen: readonly string[];
  onToggle: (result: string) => void;
}

function Visit({ visit, results, chosen, onToggle }: VisitProps) {
  const { t, date, moment } = useI18n();
  const nameOf = ({ created_at, summary }: Result) => {
    const trials = (summary.trials as string[] | undefined) ?? [];
    return [t("resultOf", { date: moment(created_at) }), ...trials].join(" · ");
  };
  return (
    <Paper withBorder p="md">
      <Group justify="space-between">
        <Anchor component={Link} href={`/visits/${visit.id}`} fw={600}>
          {date(visit.visited_on)} {visit.label}
        </Anchor>
        {visit.stage !== "none" && <Badge variant="light">{t(visit.stage === "before" ? "before" : "after")}</Badge>}
      </Group>
      <Text c="dimmed" size="sm">
        {[visit.condition, visit.treatment].filter(Boolean).join(" · ")}
      </Text>
      {results.map((result) => (
        <Group key={result.id} mt="xs" gap="xs">
          <Checkbox
            aria-label={`${t("chooseToCompare")}: ${nameOf(result)}`}
            checked={chosen.includes(result.id)}
            onChange={() => onToggle(result.id)}
          />
          <Anchor component={Link} href={`/results/${result.id}`}>
            {nameOf(result)}
          </Anchor>
          {!result.converged && <Badge color="orange">{t("notConverged")}</Badge>}
        </Group>
      ))}
    </Paper>
  );
}
