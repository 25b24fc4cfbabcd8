import { useState } from "react";
import { Group, Progress, Stack, Text } from "@mantine/core";
import { Dropzone } from "@mantine/dropzone";
import { useQueryClient } from "@tanstack/react-query";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { isWanted, send } from "./upload";

interface Sending {
  done: number;
  error?: unknown;
}

export function Upload({ visitId }: { visitId: string }) {
  const { t } = useI18n();
  const queries = useQueryClient();
  const [sending, setSending] = useState<Readonly<Record<string, Sending>>>({});
  const [ignored, setIgnored] = useState<readonly string[]>([]);
  const note = (name: string, state: Sending) => setSending((all) => ({ ...all, [name]: state }));

  const drop = async (files: File[]) => {
    const wanted = files.filter((file) => isWanted(file.name));
    setIgnored(files.filter((file) => !isWanted(file.name)).map((file) => file.name));
    for (const file of wanted) note(file.name, { done: 0 });
    // One after the other: each is cut into chunks, and a lost connection then costs one chunk.
    for (const file of wanted) {
      try {
        await send(visitId, file, (done) => note(file.name, { done }));
        note(file.name, { done: 1 });
      } catch (error) {
        note(file.name, { done: 0, error });
      }
      await queries.invalidateQueries({ queryKey: ["recordings", visitId] });
      await queries.invalidateQueries({ queryKey: ["attachments", visitId] });
    }
  };

  const unfinished = Object.entries(sending).filter(([, state]) => state.error || state.done < 1);
  return (
    <Stack gap="xs">
      <Dropzone onDrop={(files) => void drop(files)} inputProps={{ "aria-label": t("dropHere") }}>
        <Text ta="center" py="lg">
          {t("dropHere")}
          <Text span c="dimmed" display="block" size="sm">
            {t("dropHint")}
          </Text>
        </Text>
      </Dropzone>
      {ignored.length > 0 && <Text size="sm">{t("ignoredFiles", { names: ignored.join(", ") })}</Text>}
      {unfinished.map(([name, state]) => (
        <div key={name}>
          <Group justify="space-between">
            <Text size="sm">{name}</Text>
            <Text size="sm">{Math.round(100 * state.done)} %</Text>
          </Group>
          {state.error ? (
            <>
              <ErrorNote error={state.error} />
              <Text size="sm">{t("dropAgain")}</Text>
            </>
          ) : (
            <Progress value={100 * state.done} aria-label={name} />
          )}
        </div>
      ))}
    </Stack>
  );
}
