/** What this walk tells of each weight, in words. */
import { List } from "@mantine/core";
import { useI18n } from "../i18n/I18n";
import type { Criterion, Weights } from "./document";

export function Identifiability({ weights }: { weights: Weights }) {
  const { t, name, number } = useI18n();
  const interval = ({ interval_95: range }: Criterion) =>
    range ? ` ${t("interval95", { low: number(100 * range[0]), high: number(100 * range[1]) })}` : "";
  return (
    <List size="sm" data-testid="identifiability">
      {weights.criteria.map((each) => (
        <List.Item key={each.name}>
          <b>{name(each.name)}</b>: {t(each.identifiable ? "known" : each.at_bound ? "atBound" : "unknown")}
          {interval(each)}
        </List.Item>
      ))}
      {weights.not_told_apart?.map(([one, other]) => (
        <List.Item key={`${one} ${other}`}>{t("notToldApart", { one: name(one), other: name(other) })}</List.Item>
      ))}
    </List>
  );
}
