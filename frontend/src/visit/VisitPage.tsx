import { useState } from "react";
import { Anchor, Badge, Group, Stack, Text, Title } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "wouter";
import { useAccount } from "../account/Account";
import { client, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { JobCard } from "../jobs/JobCard";
import { isOver, LOOK_AGAIN_MS } from "../jobs/useJob";
import { usePatient } from "../patients/usePatient";
import { Attachments } from "./Attachments";
import { BodyParameters } from "./BodyParameters";
import type { Corrections } from "./events";
import { Examination } from "./Examination";
import { RecordingCard } from "./RecordingCard";
import { RunPanel } from "./RunPanel";
import { Upload } from "./Upload";
import { visitQuery } from "./visitQuery";

export default function VisitPage({ id }: { id: string }) {
  const { t, date } = useI18n();
  const { may } = useAccount();
  const [corrections, setCorrections] = useState<Corrections>({});
  const path = { session_id: id };
  const visit = useQuery(visitQuery(id));
  const recordings = useQuery({
    queryKey: ["recordings", id],
    queryFn: () =>
      unwrap(client.GET("/api/v1/sessions/{session_id}/recordings", { params: { path, query: { limit: 100 } } })),
    refetchInterval: ({ state }) => (state.data?.items.some((each) => !each.inspection) ? LOOK_AGAIN_MS : false),
  });
  const jobs = useQuery({
    queryKey: ["jobs", { session_id: id }],
    queryFn: () =>
      unwrap(client.GET("/api/v1/analyses", { params: { query: { session_id: id, kind: "analyse", limit: 20 } } })),
    refetchInterval: ({ state }) => (state.data?.items.every(isOver) ? false : LOOK_AGAIN_MS),
  });
  const patient = usePatient(visit.data?.patient_id ?? null);
  if (!visit.data) return <ErrorNote error={visit.error} />;
  const files = recordings.data?.items ?? [];
  return (
    <Stack maw={1100} mx="auto">
      <div>
        <Anchor component={Link} href={`/patients/${visit.data.patient_id}`}>
          {patient.data?.pseudonym ?? t("patient")}
        </Anchor>
        <Group>
          <Title order={1}>{t("visitOn", { date: date(visit.data.visited_on) })}</Title>
          {visit.data.stage !== "none" && <Badge>{t(visit.data.stage === "before" ? "before" : "after")}</Badge>}
        </Group>
        <Text c="dimmed">{[visit.data.condition, visit.data.treatment].filter(Boolean).join(" · ")}</Text>
      </div>
      <Title order={2}>{t("recordings")}</Title>
      {may("patients:write") && <Upload visitId={id} />}
      <ErrorNote error={recordings.error} />
      {files.map((recording) => (
        <RecordingCard
          key={recording.id}
          recording={recording}
          corrected={corrections[recording.id]}
          onCorrect={(events) => setCorrections(withEvents(corrections, recording.id, events))}
        />
      ))}
      <Attachments visitId={id} />
      {files.length > 0 && (
        <>
          <BodyParameters visitId={id} recordings={files} />
          {may("analyses:run") && <RunPanel visitId={id} recordings={files} corrections={corrections} />}
        </>
      )}
      <Analyses jobs={jobs.data?.items ?? []} />
      <Examination visit={visit.data} />
    </Stack>
  );
}

/** The corrections with other events of one recording; none: those of the file. */
function withEvents(corrections: Corrections, id: string, events: Corrections[string] | undefined): Corrections {
  const { [id]: _, ...others } = corrections;
  return events ? { ...others, [id]: events } : others;
}

function Analyses({ jobs }: { jobs: readonly Schemas["Job"][] }) {
  const { t } = useI18n();
  if (jobs.length === 0) return null;
  return (
    <>
      <Title order={2}>{t("analyses")}</Title>
      {jobs.map((job) => (
        <JobCard key={job.id} job={job} />
      ))}
    </>
  );
}
