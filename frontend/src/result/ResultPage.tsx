import { useMemo } from "react";
import { Alert, Anchor, Badge, Breadcrumbs, Group, List, Stack, Tabs, Text, Title } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "wouter";
import { client, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { usePatient } from "../patients/usePatient";
import { useAttachments } from "../visit/Attachments";
import { CurvesTab } from "./CurvesTab";
import { Cursor } from "./cursor";
import type { ResultDocument } from "./document";
import { NumbersTab } from "./NumbersTab";
import { ReportTab } from "./ReportTab";
import { useResultDocument } from "./useResultDocument";
import { isVideo } from "./VideoPane";
import { WeightsTab } from "./WeightsTab";

export default function ResultPage({ id }: { id: string }) {
  const { t } = useI18n();
  const cursor = useMemo(() => new Cursor(), []);
  const result = useQuery({
    queryKey: ["result", id],
    queryFn: () => unwrap(client.GET("/api/v1/results/{result_id}", { params: { path: { result_id: id } } })),
  });
  const document = useResultDocument(id);
  const attachments = useAttachments(result.data?.session_id ?? null);
  const videos = useMemo(() => (attachments.data?.items ?? []).filter(isVideo), [attachments.data]);
  if (!result.data || !document.data) return <ErrorNote error={result.error ?? document.error} />;
  return (
    <Stack>
      <Heading result={result.data} document={document.data} />
      <Tabs defaultValue="curves" keepMounted={false}>
        <Tabs.List className="no-print">
          <Tabs.Tab value="curves">{t("curves")}</Tabs.Tab>
          <Tabs.Tab value="weights">{t("weights")}</Tabs.Tab>
          <Tabs.Tab value="numbers">{t("numbers")}</Tabs.Tab>
          <Tabs.Tab value="report">{t("report")}</Tabs.Tab>
        </Tabs.List>
        <Tabs.Panel value="curves" pt="md">
          <CurvesTab resultId={id} document={document.data} cursor={cursor} videos={videos} />
        </Tabs.Panel>
        <Tabs.Panel value="weights" pt="md">
          <WeightsTab resultId={id} document={document.data} />
        </Tabs.Panel>
        <Tabs.Panel value="numbers" pt="md">
          <NumbersTab document={document.data} />
        </Tabs.Panel>
        <Tabs.Panel value="report" pt="md">
          <ReportTab result={result.data} />
        </Tabs.Panel>
      </Tabs>
    </Stack>
  );
}

function Heading({ result, document }: { result: Schemas["ResultWithFiles"]; document: ResultDocument }) {
  const { t, date } = useI18n();
  const patient = usePatient(result.patient_id);
  const walks = document.inputs.filter((input) => input.role === "walk").map((input) => input.name);
  return (
    <>
      <Breadcrumbs>
        {patient.data && (
          <Anchor component={Link} href={`/patients/${patient.data.id}`}>
            {patient.data.pseudonym}
          </Anchor>
        )}
        {result.session_id && (
          <Anchor component={Link} href={`/visits/${result.session_id}`}>
            {t("visit")}
          </Anchor>
        )}
      </Breadcrumbs>
      <Group>
        <Title order={1}>
          {t(document.prediction ? "prediction" : "result")} {patient.data?.pseudonym}
        </Title>
        {!result.converged && <Badge color="orange">{t("notConverged")}</Badge>}
      </Group>
      <Text c="dimmed">
        {date(result.created_at)} · {walks.join(", ")} · gaitlab {document.version}
      </Text>
      {result.message && <Alert color="orange">{result.message}</Alert>}
      {document.warnings.length > 0 && (
        <Alert color="yellow" title={t("warnings")}>
          <List size="sm">
            {document.warnings.map((warning) => (
              <List.Item key={warning}>{warning}</List.Item>
            ))}
          </List>
        </Alert>
      )}
    </>
  );
}
