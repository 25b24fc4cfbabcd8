/** The weights as bars, with their uncertainty and what is usual. */
import { Group, Paper, Stack, Text } from "@mantine/core";
import { criterionColour, useColours } from "../app/colours";
import { useI18n } from "../i18n/I18n";
import type { Criterion, Reference, Weights } from "./document";

export function WeightBars({ weights, reference }: { weights: Weights; reference: Reference | null }) {
  const { name, number, t } = useI18n();
  const colours = useColours();
  return (
    <Paper withBorder p="md">
      <Stack gap="xs" data-testid="weights">
        {weights.criteria.map((each, index) => {
          const norm = reference?.weights?.[each.name];
          return (
            <Group key={each.name} wrap="nowrap" align="center">
              <Text w={200}>{name(each.name)}</Text>
              <Bar criterion={each} colour={criterionColour(colours, index)} norm={norm} />
              <Text w={150} ta="right">
                {number(100 * each.weight)} {each.sd !== null && `± ${number(100 * each.sd)} `}%
              </Text>
              <Text w={150} size="sm" c="dimmed">
                {each.cost_share != null && t("costShare", { value: number(100 * each.cost_share, 0) })}
              </Text>
            </Group>
          );
        })}
      </Stack>
    </Paper>
  );
}

interface BarProps {
  criterion: Criterion;
  colour: string;
  norm: { mean: number; sd: number } | undefined;
}

function clip(value: number): number {
  return Math.min(Math.max(100 * value, 0), 100);
}

/** Weight as a bar, its uncertainty as a whisker, the reference interval grey behind. */
function Bar({ criterion, colour, norm }: BarProps) {
  const { weight, sd } = criterion;
  return (
    <svg viewBox="0 0 100 10" preserveAspectRatio="none" style={{ flex: 1, height: 26 }} aria-hidden>
      <rect width="100" height="10" fill="var(--mantine-color-default-border)" opacity={0.35} />
      {norm && (
        <rect
          x={clip(norm.mean - norm.sd)}
          width={clip(norm.mean + norm.sd) - clip(norm.mean - norm.sd)}
          height="10"
          fill="gray"
          opacity={0.5}
        />
      )}
      <rect y="2" width={clip(weight)} height="6" fill={colour} opacity={criterion.identifiable ? 1 : 0.35} />
      {sd !== null && (
        <rect x={clip(weight - sd)} y="4.6" width={clip(weight + sd) - clip(weight - sd)} height="0.8" fill="var(--mantine-color-text)" />
      )}
    </svg>
  );
}
