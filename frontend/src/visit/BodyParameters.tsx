/** Body measurements as the files hold them, and corrections, which are kept with the visit. */
import { useState } from "react";
import { Button, Group, NumberInput, Paper, SimpleGrid, Text, Title } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useAccount } from "../account/Account";
import { client, ifMatch, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { foundIn } from "./inspection";

type Values = Readonly<Record<string, number>>;
/** What the conventional gait model cannot do without. */
const NEEDED = [
  "mass",
  "height",
  "left_leg_length",
  "right_leg_length",
  "left_knee_width",
  "right_knee_width",
  "left_ankle_width",
  "right_ankle_width",
] as const;

/** The first value of each parameter that the files give. */
export function fromFiles(recordings: readonly Schemas["Recording"][]): Values {
  const found = recordings.map((each) => foundIn(each)?.parameters ?? {});
  return Object.assign({}, ...found.reverse()) as Values;
}

/** The visit's corrections. */
export function useSubject(visitId: string) {
  return useQuery({
    queryKey: ["subject", visitId],
    queryFn: async () => {
      const params = { path: { session_id: visitId }, query: { limit: 1 } };
      const page = await unwrap(client.GET("/api/v1/sessions/{session_id}/subjects", { params }));
      return page.items[0] ?? null;
    },
  });
}

interface Props {
  visitId: string;
  recordings: readonly Schemas["Recording"][];
}

export function BodyParameters({ visitId, recordings }: Props) {
  const { t, name } = useI18n();
  const { may } = useAccount();
  const queries = useQueryClient();
  const subject = useSubject(visitId);
  const about = useQuery({ queryKey: ["about"], queryFn: () => unwrap(client.GET("/api/v1/about")) });
  const [edited, setEdited] = useState<Values>({});
  const save = useMutation({
    mutationFn: () => saveSubject(visitId, subject.data ?? null, { ...subject.data?.parameters, ...edited }),
    onSuccess: () => {
      setEdited({});
      return queries.invalidateQueries({ queryKey: ["subject", visitId] });
    },
  });
  const files = fromFiles(recordings);
  const shown = { ...files, ...subject.data?.parameters, ...edited };
  const missing = NEEDED.filter((each) => shown[each] === undefined);
  return (
    <Paper withBorder p="md">
      <Title order={2}>{t("body")}</Title>
      {missing.length > 0 && (
        <Text c="var(--mantine-color-orange-text)">
          {t("missingParameters", { names: missing.map((each) => name(each)).join(", ") })}
        </Text>
      )}
      <SimpleGrid cols={{ base: 2, md: 4 }} mt="xs">
        {NEEDED.map((each) => (
          <NumberInput
            key={each}
            label={`${name(each)} [${about.data?.body_parameters[each]?.[2] ?? ""}]`}
            value={shown[each] ?? ""}
            disabled={!may("patients:write")}
            decimalScale={4}
            step={0.01}
            onChange={(value) => typeof value === "number" && setEdited({ ...edited, [each]: value })}
          />
        ))}
      </SimpleGrid>
      <ErrorNote error={save.error} />
      <Group justify="end" mt="sm">
        <Button
          variant="default"
          disabled={Object.keys(edited).length === 0}
          loading={save.isPending}
          onClick={() => save.mutate()}
        >
          {t("keepCorrections")}
        </Button>
      </Group>
    </Paper>
  );
}

function saveSubject(visitId: string, subject: Schemas["Subject"] | null, parameters: Record<string, number>) {
  if (!subject) {
    const params = { path: { session_id: visitId } };
    return unwrap(client.POST("/api/v1/sessions/{session_id}/subjects", { params, body: { parameters } }));
  }
  const params = { path: { subject_id: subject.id }, header: ifMatch(subject.version) };
  return unwrap(client.PATCH("/api/v1/subjects/{subject_id}", { params, body: { parameters } }));
}
