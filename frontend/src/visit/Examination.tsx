/** The clinical examination of a visit: read, and edited. */
import { useState } from "react";
import { Button, Group, Paper, SimpleGrid, Stack, Table, Text, Textarea, TextInput, Title } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useAccount } from "../account/Account";
import { client, ifMatch, unwrap, type Schemas } from "../api/client";
import { FormEnd } from "../app/FormEnd";
import { RowsEditor, type Row } from "../app/RowsEditor";
import { submitting } from "../app/submitting";
import { useI18n, type Key } from "../i18n/I18n";

type Visit = Schemas["Session"];

interface Entries {
  condition?: Readonly<Record<string, string>>;
  ranges?: readonly Row[];
  strength?: readonly Row[];
  spasticity?: readonly Row[];
  notes?: readonly string[];
}

const CONDITION = ["footwear", "orthosis", "walking_aid", "note"] as const;
const PARTS = {
  ranges: ["joint", "motion", "left", "right", "note"],
  strength: ["muscle", "left", "right", "note"],
  spasticity: ["muscle", "left", "right", "note"],
} as const;
type Part = keyof typeof PARTS;
const ORDER = Object.keys(PARTS) as Part[];

/** A row without the cells that nobody filled. */
function filled(row: Row): Row {
  return Object.fromEntries(Object.entries(row).filter(([, value]) => value !== null && value !== ""));
}

export function Examination({ visit }: { visit: Visit }) {
  const { t } = useI18n();
  const { may } = useAccount();
  const [editing, setEditing] = useState(false);
  const entries = visit.examination as Entries;
  return (
    <Paper withBorder p="md">
      <Group justify="space-between">
        <Title order={2}>{t("examination")}</Title>
        {may("patients:write") && !editing && (
          <Button size="xs" variant="default" className="no-print" onClick={() => setEditing(true)}>
            {t("edit")}
          </Button>
        )}
      </Group>
      {editing ? (
        <Editor visit={visit} entries={entries} onDone={() => setEditing(false)} />
      ) : (
        <Reading entries={entries} />
      )}
    </Paper>
  );
}

function Reading({ entries }: { entries: Entries }) {
  const { t } = useI18n();
  const condition = CONDITION.filter((each) => entries.condition?.[each]);
  const parts = ORDER.filter((part) => entries[part]?.length);
  const notes = entries.notes ?? [];
  if (condition.length + parts.length + notes.length === 0) return <Text c="dimmed">{t("notExamined")}</Text>;
  return (
    <Stack gap="xs">
      {condition.map((each) => (
        <Text key={each}>
          <b>{t(`exam_${each}` as Key)}</b>: {entries.condition?.[each]}
        </Text>
      ))}
      {parts.map((part) => (
        <Table key={part} aria-label={t(`exam_${part}` as Key)}>
          <Table.Caption style={{ captionSide: "top", textAlign: "start" }}>{t(`exam_${part}` as Key)}</Table.Caption>
          <Table.Thead>
            <Table.Tr>
              {PARTS[part].map((key) => (
                <Table.Th key={key}>{t(`exam_${key}` as Key)}</Table.Th>
              ))}
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {entries[part]?.map((row, index) => (
              <Table.Tr key={index}>
                {PARTS[part].map((key) => (
                  <Table.Td key={key}>{row[key] ?? "–"}</Table.Td>
                ))}
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      ))}
      {notes.map((note) => (
        <Text key={note}>{note}</Text>
      ))}
    </Stack>
  );
}

function Editor({ visit, entries, onDone }: { visit: Visit; entries: Entries; onDone: () => void }) {
  const { t } = useI18n();
  const queries = useQueryClient();
  const [edited, setEdited] = useState(entries);
  const save = useMutation({
    mutationFn: () => {
      const rows = Object.fromEntries(ORDER.map((part) => [part, (edited[part] ?? []).map(filled)]));
      return unwrap(
        client.PATCH("/api/v1/sessions/{session_id}", {
          params: { path: { session_id: visit.id }, header: ifMatch(visit.version) },
          body: { examination: { ...edited, ...rows } },
        }),
      );
    },
    onSuccess: async () => {
      await queries.invalidateQueries({ queryKey: ["visit", visit.id] });
      onDone();
    },
  });
  return (
    <form onSubmit={submitting(save.mutate)}>
      <Stack>
        <SimpleGrid cols={{ base: 1, sm: 2, lg: 4 }}>
          {CONDITION.map((each) => (
            <TextInput
              key={each}
              label={t(`exam_${each}` as Key)}
              value={edited.condition?.[each] ?? ""}
              onChange={(event) =>
                setEdited({ ...edited, condition: { ...edited.condition, [each]: event.currentTarget.value } })
              }
            />
          ))}
        </SimpleGrid>
        {ORDER.map((part) => (
          <div key={part}>
            <Title order={3} size="h5">
              {t(`exam_${part}` as Key)}
            </Title>
            <RowsEditor
              label={t(`exam_${part}` as Key)}
              columns={PARTS[part].map((key) => ({
                key,
                label: t(`exam_${key}` as Key),
                // Ranges are degrees; grades such as 4+ are texts.
                ...(part === "ranges" && (key === "left" || key === "right") ? { step: 5 } : {}),
              }))}
              rows={edited[part] ?? []}
              blank={{}}
              onChange={(rows) => setEdited({ ...edited, [part]: rows })}
            />
          </div>
        ))}
        <Textarea
          label={t("exam_notes")}
          autosize
          value={(edited.notes ?? []).join("\n")}
          onChange={(event) => setEdited({ ...edited, notes: event.currentTarget.value.split("\n").filter(Boolean) })}
        />
        <FormEnd save={save}>
          <Button variant="default" onClick={onDone}>
            {t("cancel")}
          </Button>
        </FormEnd>
      </Stack>
    </form>
  );
}
