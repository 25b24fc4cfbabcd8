/** Weights of several results: a stacked bar each. */
import { Group, ScrollArea, Stack, Text } from "@mantine/core";
import { criterionColour, useColours } from "../app/colours";
import { useI18n } from "../i18n/I18n";
import type { Quantity, Wide } from "./wide";

/** Bars that are drawn; the table has all. */
const MOST = 40;

interface Props {
  quantities: readonly Quantity[];
  wide: Wide;
  labels: ReadonlyMap<string, string>;
}

export function WeightsPlot({ quantities, wide, labels }: Props) {
  const { t, name, number } = useI18n();
  const colours = useColours();
  const colour = (index: number) => criterionColour(colours, index);
  const shown = [...wide.values].filter(([, values]) => quantities.some(({ key }) => values.has(key))).slice(0, MOST);
  return (
    <Stack gap="xs" data-testid="weights-plot">
      <Group gap="md">
        {quantities.map((each, index) => (
          <Text size="sm" key={each.key}>
            <span className="swatch" style={{ background: colour(index) }} /> {name(each.name)}
          </Text>
        ))}
      </Group>
      <ScrollArea.Autosize mah={420} viewportProps={{ tabIndex: 0, role: "region", "aria-label": t("weights") }}>
        {shown.map(([id, values]) => (
          <Group key={id} wrap="nowrap" mb={4}>
            <Text size="sm" w="35%">
              {labels.get(id)}
            </Text>
            <div
              className="stack"
              role="img"
              aria-label={quantities
                .map((each) => `${name(each.name)} ${number(100 * (values.get(each.key) ?? 0), 0)} %`)
                .join(", ")}
            >
              {quantities.map((each, index) => (
                <div key={each.key} style={{ width: `${100 * (values.get(each.key) ?? 0)}%`, background: colour(index) }} />
              ))}
            </div>
          </Group>
        ))}
      </ScrollArea.Autosize>
    </Stack>
  );
}
