/** Events of a walk on a time line and in a table: as the file has them, or corrected for the next analysis. */
import { Badge, Button, Group, Stack, Text } from "@mantine/core";
import { RowsEditor, type Row } from "../app/RowsEditor";
import { useI18n } from "../i18n/I18n";
import type { CorrectedEvent } from "./events";
import type { Timing } from "./inspection";
import { TimeLine } from "./TimeLine";
import { axisOf } from "./timeAxis";

interface Props {
  timing: Timing | null;
  stored: readonly CorrectedEvent[];
  corrected: readonly CorrectedEvent[] | undefined;
  onChange: (events: readonly CorrectedEvent[] | undefined) => void;
}

const BLANK: Row = { side: "left", kind: "foot_strike", time_s: 0 };

export function EventEditor({ timing, stored, corrected, onChange }: Props) {
  const { t, name } = useI18n();
  const events = corrected ?? stored;
  const axis = axisOf(timing, events);
  const rows = events.map(({ side, kind, time_s }): Row => ({ side, kind, time_s }));
  return (
    <Stack gap={4} mt="sm">
      <Group>
        <Text fw={600}>{t("events")}</Text>
        {corrected && <Badge variant="light">{t("correctedForNextRun")}</Badge>}
        {corrected && (
          <Button size="xs" variant="subtle" onClick={() => onChange(undefined)}>
            {t("asInFile")}
          </Button>
        )}
      </Group>
      {rows.length === 0 && <Text size="sm">{t("eventsAreDetected")}</Text>}
      {events.length > 0 && <TimeLine events={events} axis={axis} onChange={onChange} />}
      <RowsEditor
        label={t("events")}
        columns={[
          { key: "side", label: t("side"), choices: ["left", "right"].map((value) => ({ value, label: name(value) })) },
          {
            key: "kind",
            label: t("kind"),
            choices: ["foot_strike", "foot_off"].map((value) => ({ value, label: name(value) })),
          },
          { key: "time_s", label: `${t("time")} [s]`, step: axis.frame, digits: 3 },
        ]}
        rows={rows}
        blank={BLANK}
        onChange={(changed) => onChange(changed.map((row) => ({ ...row, time_s: row.time_s ?? 0 }) as CorrectedEvent))}
      />
    </Stack>
  );
}
