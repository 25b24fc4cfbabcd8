/** Which results are compared. */
import { useDeferredValue, useState } from "react";
import { Button, Checkbox, Group, ScrollArea, Stack, Text, TextInput } from "@mantine/core";
import { useI18n } from "../i18n/I18n";
import type { Named } from "./results";

/** Boxes that are drawn at a time. */
const STEP = 25;

interface Props {
  named: readonly Named[];
  labelOf: (named: Named) => string;
  chosen: readonly string[];
  choose: (ids: readonly string[]) => void;
}

export function Choice(props: Props) {
  const { t } = useI18n();
  const [opened, setOpened] = useState(props.chosen.length < 2);
  return (
    <details open={opened} className="no-print" onToggle={(event) => setOpened(event.currentTarget.open)}>
      <summary>{t("chooseResults", { count: props.chosen.length })}</summary>
      {opened && <Boxes {...props} />}
    </details>
  );
}

function Boxes({ named, labelOf, chosen, choose }: Props) {
  const { t } = useI18n();
  const [typed, setTyped] = useState("");
  const [shown, setShown] = useState(STEP);
  const words = useDeferredValue(typed).toLowerCase();
  const found = named.filter((each) => labelOf(each).toLowerCase().includes(words));
  const marked = new Set(chosen);
  const toggle = (id: string) => choose(marked.has(id) ? chosen.filter((each) => each !== id) : [...chosen, id]);
  return (
    <Stack gap="xs" mt="xs">
      <Group align="end">
        <TextInput label={t("search")} value={typed} onChange={(event) => setTyped(event.currentTarget.value)} />
        <Button variant="default" onClick={() => choose(found.map(({ result }) => result.id))}>
          {t("chooseAll", { count: found.length })}
        </Button>
        <Button variant="default" disabled={chosen.length === 0} onClick={() => choose([])}>
          {t("chooseNone")}
        </Button>
      </Group>
      {named.length === 0 && <Text c="dimmed">{t("noResults")}</Text>}
      <ScrollArea.Autosize mah={320} viewportProps={{ tabIndex: 0, role: "region", "aria-label": t("compare") }}>
        <Stack gap={6} p={4}>
          {found.slice(0, shown).map((each) => (
            <Checkbox
              key={each.result.id}
              label={labelOf(each)}
              checked={marked.has(each.result.id)}
              onChange={() => toggle(each.result.id)}
            />
          ))}
          {found.length > shown && (
            <Button variant="subtle" onClick={() => setShown(shown + STEP)}>
              {t("showMore", { count: found.length - shown })}
            </Button>
          )}
        </Stack>
      </ScrollArea.Autosize>
    </Stack>
  );
}
