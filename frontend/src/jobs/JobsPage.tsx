import { useState } from "react";
import { Group, NativeSelect, Stack, Text, Title } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { client, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n, type Key } from "../i18n/I18n";
import { JobCard } from "./JobCard";
import type { Job } from "./progress";
import { isOver, LOOK_AGAIN_MS } from "./useJob";

const STATES: Job["status"][] = ["queued", "running", "succeeded", "failed", "cancelled"];
const REFRESH_MS = 10_000;

export default function JobsPage() {
  const { t } = useI18n();
  const [status, setStatus] = useState<Job["status"] | "">("");
  const jobs = useQuery({
    queryKey: ["jobs", { status }],
    queryFn: () =>
      unwrap(client.GET("/api/v1/analyses", { params: { query: { ...(status ? { status } : {}), limit: 50 } } })),
    refetchInterval: ({ state }) => (state.data?.items.every(isOver) ? REFRESH_MS : LOOK_AGAIN_MS),
  });
  return (
    <Stack maw={1100} mx="auto">
      <Group justify="space-between">
        <Title order={1}>{t("jobs")}</Title>
        <NativeSelect
          label={t("filterByState")}
          value={status}
          onChange={(event) => setStatus(event.currentTarget.value as Job["status"] | "")}
          data={[
            { value: "", label: t("all") },
            ...STATES.map((value) => ({ value, label: t(`status_${value}` as Key) })),
          ]}
        />
      </Group>
      <ErrorNote error={jobs.error} />
      {jobs.data?.items.length === 0 && <Text c="dimmed">{t("noJobs")}</Text>}
      {jobs.data?.items.map((job) => (
        <JobCard key={job.id} job={job} elsewhere />
      ))}
    </Stack>
  );
}
