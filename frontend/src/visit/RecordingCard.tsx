import { Alert, Badge, Button, Collapse, Group, Loader, NativeSelect, Paper, Table, Text } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useAccount } from "../account/Account";
import { client, ifMatch, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { EventEditor } from "./EventEditor";
import type { CorrectedEvent } from "./events";
import { foundIn, type Found } from "./inspection";

type Recording = Schemas["Recording"];
type Kind = Schemas["RecordingKind"];

interface Props {
  recording: Recording;
  corrected: readonly CorrectedEvent[] | undefined;
  onCorrect: (events: readonly CorrectedEvent[] | undefined) => void;
}

export function RecordingCard({ recording, corrected, onCorrect }: Props) {
  const { t } = useI18n();
  const { may } = useAccount();
  const queries = useQueryClient();
  const [open, details] = useDisclosure();
  const refresh = () => queries.invalidateQueries({ queryKey: ["recordings", recording.session_id] });
  const where = { path: { recording_id: recording.id }, header: ifMatch(recording.version) };
  const setKind = useMutation({
    mutationFn: (kind: Kind) =>
      unwrap(client.PATCH("/api/v1/recordings/{recording_id}", { params: where, body: { kind } })),
    onSettled: refresh,
  });
  const strip = useMutation({
    mutationFn: () => unwrap(client.POST("/api/v1/recordings/{recording_id}/strip", { params: where })),
    onSettled: refresh,
  });
  const remove = useMutation({
    mutationFn: () => unwrap(client.DELETE("/api/v1/recordings/{recording_id}", { params: where })),
    onSettled: refresh,
  });
  const found = foundIn(recording);
  return (
    <Paper withBorder p="sm" data-testid="recording">
      <Group justify="space-between">
        <Group>
          <Text fw={600}>{recording.name}</Text>
          {found ? <Badges found={found} /> : <Loader size="xs" role="status" aria-label={t("reading")} />}
        </Group>
        <Group gap="xs" ml="auto">
          <NativeSelect
            size="xs"
            aria-label={t("kindOf", { name: recording.name })}
            value={recording.kind}
            disabled={!may("patients:write")}
            onChange={(event) => setKind.mutate(event.currentTarget.value as Kind)}
            data={[
              { value: "static", label: t("staticTrial") },
              { value: "walk", label: t("walkTrial") },
              { value: "other", label: t("otherTrial") },
            ]}
          />
          <Button size="xs" variant="default" disabled={!found} aria-expanded={open} onClick={details.toggle}>
            {t("whatWasRead")}
          </Button>
          {may("patients:write") && (
            <Button size="xs" variant="default" onClick={() => remove.mutate()}>
              {t("delete")}
              <span className="unseen"> {recording.name}</span>
            </Button>
          )}
        </Group>
      </Group>
      <ErrorNote error={setKind.error ?? strip.error ?? remove.error} />
      {recording.personal_entries.length > 0 && (
        <Alert color="orange" mt="xs" title={t("namesInHeader")}>
          {recording.personal_entries.join("; ")}
          {may("patients:write") && (
            <Button size="xs" mt="xs" display="block" loading={strip.isPending} onClick={() => strip.mutate()}>
              {t("blankNames")}
            </Button>
          )}
        </Alert>
      )}
      {found && (
        <Collapse expanded={open}>
          <Details found={found} />
          {recording.kind === "walk" && may("analyses:run") && (
            <EventEditor
              timing={found.timing}
              stored={found.eventTimes}
              corrected={corrected}
              onChange={onCorrect}
            />
          )}
        </Collapse>
      )}
    </Paper>
  );
}

function Badges({ found }: { found: Found }) {
  const { t } = useI18n();
  return (
    <Group gap={6}>
      <Badge variant="default">{t("markerCount", { count: found.markers.length })}</Badge>
      <Badge variant="default">{t(found.gaps.length ? "gapCount" : "noGaps", { count: found.gaps.length })}</Badge>
      <Badge variant="default">{t(found.plates.length ? "withPlates" : "noPlates")}</Badge>
      <Badge variant="default">{t(found.events.length ? "withEvents" : "noEvents")}</Badge>
      {found.warnings.length > 0 && (
        <Badge variant="outline" color="orange">
          {t("warningCount", { count: found.warnings.length })}
        </Badge>
      )}
    </Group>
  );
}

function Details({ found }: { found: Found }) {
  const { t, name, number, plain } = useI18n();
  const { timing } = found;
  const events = found.events.map(({ count, side, kind }) => `${count} × ${name(kind)} ${name(side).toLowerCase()}`);
  const plates = found.plates.map((each) =>
    t("plateFound", { number: each.number, newton: each.newton, rate: plain(each.rate) }),
  );
  const rows: [string, string][] = [
    [
      t("frames"),
      timing
        ? t("framesFound", {
            frames: timing.frames,
            rate: plain(timing.rate),
            seconds: number(timing.frames / timing.rate, 2),
          })
        : "–",
    ],
    [t("markers"), found.markers.join(", ")],
    [t("gaps"), found.gaps.join(", ") || "–"],
    [t("events"), events.join(", ") || "–"],
    [t("plates"), plates.join(", ") || "–"],
    [t("warnings"), found.warnings.join("; ") || "–"],
  ];
  return (
    <Table mt="xs">
      <Table.Tbody>
        {rows.map(([title, text]) => (
          <Table.Tr key={title}>
            <Table.Th w={160}>{title}</Table.Th>
            <Table.Td>{text}</Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}
