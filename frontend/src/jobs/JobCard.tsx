import { Alert, Anchor, Badge, Button, Code, Group, NativeSelect, Paper, Progress, Text } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { Link } from "wouter";
import { useAccount } from "../account/Account";
import { client, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n, type Key } from "../i18n/I18n";
import { secondsLeft, type History, type Job } from "./progress";
import { ResidualChart } from "./ResidualChart";
import { isOver, useJob } from "./useJob";

const COLOURS: Record<Job["status"], string> = {
  queued: "gray",
  running: "blue",
  succeeded: "teal",
  failed: "red",
  cancelled: "gray",
};

interface Props {
  job: Job;
  /** Whether the card stands on another page than its visit's. */
  elsewhere?: boolean;
}

export function JobCard({ job: given, elsewhere = false }: Props) {
  const { t, told, moment } = useI18n();
  const { job, history } = useJob(given);
  const walks = job.inputs.filter((each) => each.role === "walk").map((each) => each.name);
  return (
    <Paper withBorder p="md" data-testid="job">
      <Group justify="space-between">
        <Group>
          <Badge color={COLOURS[job.status]} variant="light">
            {t(`status_${job.status}` as Key)}
          </Badge>
          <Text fw={600}>{t(`kind_${job.kind}` as Key)}</Text>
          <Text c="dimmed" size="sm">
            {[moment(job.created_at), ...walks].join(" · ")}
          </Text>
          {elsewhere && job.session_id && (
            <Anchor component={Link} size="sm" href={`/visits/${job.session_id}`}>
              {t("visit")}
            </Anchor>
          )}
        </Group>
        <Actions job={job} />
      </Group>
      {job.status === "queued" && <Text c="dimmed">{t("waitsInQueue")}</Text>}
      {job.status === "running" && <Live history={history} title={told(history.told.stage || "starting")} />}
      {job.error && (
        <Alert color="red" mt="sm" title={t("whatHappened")}>
          {job.error}
          {job.failure && <Failure failure={job.failure} />}
        </Alert>
      )}
    </Paper>
  );
}

function Live({ history, title }: { history: History; title: string }) {
  const { t, number, small } = useI18n();
  const { told } = history;
  const left = secondsLeft(told);
  const facts = [
    told.trial,
    told.iteration != null && t("iteration", { count: told.iteration }),
    told.residual != null && t("residual", { value: small(told.residual) }),
    told.seconds != null && t("seconds", { value: number(told.seconds, 0) }),
    left != null && t("secondsLeft", { value: number(left, 0) }),
  ].filter(Boolean);
  return (
    <div aria-live="polite">
      <Text mt="xs">
        <b>{title}</b> {facts.join(" · ")}
      </Text>
      <Progress mt={6} value={100 * (told.done ?? 1)} animated={told.done == null} aria-label={title} />
      {history.iterations.length > 2 && <ResidualChart history={history} />}
    </div>
  );
}

function Failure({ failure }: { failure: Readonly<Record<string, unknown>> }) {
  const known = Object.entries(failure).filter(([, value]) => value !== null && value !== "");
  return (
    <Code block mt="xs">
      {known.map(([name, value]) => `${name}: ${String(value)}`).join("\n")}
    </Code>
  );
}

function Actions({ job }: { job: Job }) {
  const { t } = useI18n();
  const { may } = useAccount();
  const queries = useQueryClient();
  const params = { path: { analysis_id: job.id } };
  const refresh = () => queries.invalidateQueries({ queryKey: ["jobs"] });
  const cancel = useMutation({
    mutationFn: () => unwrap(client.POST("/api/v1/analyses/{analysis_id}/cancel", { params })),
    onSettled: refresh,
  });
  const retry = useMutation({
    mutationFn: () => unwrap(client.POST("/api/v1/analyses/{analysis_id}/retry", { params })),
    onSettled: refresh,
  });
  const hurry = useMutation({
    mutationFn: (priority: number) =>
      unwrap(client.PUT("/api/v1/analyses/{analysis_id}/priority", { params, body: { priority } })),
    onSettled: refresh,
  });
  const canRetry = job.status === "failed" || job.status === "cancelled";
  return (
    <Group gap="xs">
      <ErrorNote error={cancel.error ?? retry.error ?? hurry.error} />
      {may("system:read") && job.status === "queued" && (
        <NativeSelect
          size="xs"
          aria-label={t("priority")}
          value={String(job.priority)}
          onChange={(event) => hurry.mutate(Number(event.currentTarget.value))}
          data={[...new Set([10, 5, 0, -5, -10, job.priority])].map((value) => ({
            value: String(value),
            label: t("priorityOf", { value }),
          }))}
        />
      )}
      {may("analyses:run") && !isOver(job) && (
        <Button
          size="xs"
          variant="default"
          loading={cancel.isPending || job.cancel_requested}
          onClick={() => cancel.mutate()}
        >
          {t("cancel")}
        </Button>
      )}
      {may("analyses:run") && canRetry && (
        <Button size="xs" variant="default" loading={retry.isPending} onClick={() => retry.mutate()}>
          {t("retry")}
        </Button>
      )}
      {job.result_id && (job.kind === "analyse" || job.kind === "predict") && (
        <Button size="xs" component={Link} href={`/results/${job.result_id}`}>
          {t("showResult")}
        </Button>
      )}
    </Group>
  );
}
