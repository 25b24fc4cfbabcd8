import { List, Stack, Table, Text, Title } from "@mantine/core";
import { useI18n } from "../i18n/I18n";
import { digitsOf } from "./digits";
import { SIDES, type ResultDocument } from "./document";

interface Row {
  name: string;
  left: string;
  right: string;
  norm: string;
}

export function NumbersTab({ document }: { document: ResultDocument }) {
  const { t, name } = useI18n();
  const spread = useSpread();
  const { scores, spatiotemporal, prediction } = document;
  const reference = scores?.reference;
  const quantities = Object.keys(spatiotemporal.left?.mean ?? spatiotemporal.right?.mean ?? {});
  const walk = quantities.map((quantity): Row => {
    const [left, right] = SIDES.map((side) => {
      const told = spatiotemporal[side];
      return spread(told?.mean[quantity], told?.sd[quantity], digitsOf(quantity));
    });
    const norm = reference?.spatiotemporal?.[quantity];
    const usual = spread(norm?.mean, norm?.sd, digitsOf(quantity));
    return { name: name(quantity), left: left ?? "–", right: right ?? "–", norm: usual };
  });
  const variables = Object.keys(scores?.left?.gvs ?? scores?.right?.gvs ?? {});
  const profile = variables.map((variable): Row => {
    const norm = reference?.gvs?.[variable];
    return {
      name: name(variable),
      left: spread(scores?.left?.gvs[variable], null, 1),
      right: spread(scores?.right?.gvs[variable], null, 1),
      norm: spread(norm?.mean, norm?.sd, 1),
    };
  });
  const gps: Row = {
    name: "GPS",
    left: spread(scores?.left?.gps, null, 1),
    right: spread(scores?.right?.gps, null, 1),
    norm: spread(reference?.gps?.mean, reference?.gps?.sd, 1),
  };
  return (
    <Stack maw={1000}>
      {prediction && <Predicted prediction={prediction} />}
      <Title order={2}>{t("distancesAndTimes")}</Title>
      <Sides rows={walk} />
      {scores && (
        <>
          <Title order={2}>{t("profile")}</Title>
          <Sides rows={[...profile, gps]} />
          <Text>
            {t("gpsOverall")}: <b>{spread(scores.gps_overall, null, 1)}°</b>
          </Text>
          <List size="sm">
            {scores.missing?.map((sentence) => (
              <List.Item key={sentence}>{sentence}</List.Item>
            ))}
          </List>
        </>
      )}
    </Stack>
  );
}

function useSpread() {
  const { number } = useI18n();
  return (mean: number | null | undefined, sd: number | null | undefined, digits: number) =>
    sd == null ? number(mean, digits) : `${number(mean, digits)} ± ${number(sd, digits)}`;
}

function Sides({ rows }: { rows: readonly Row[] }) {
  const { t } = useI18n();
  return (
    <Table striped layout="fixed">
      <Table.Thead>
        <Table.Tr>
          <Table.Th>{t("quantity")}</Table.Th>
          <Table.Th>{t("left")}</Table.Th>
          <Table.Th>{t("right")}</Table.Th>
          <Table.Th>{t("norm")}</Table.Th>
        </Table.Tr>
      </Table.Thead>
      <Table.Tbody>
        {rows.map((row) => (
          <Table.Tr key={row.name}>
            <Table.Th fw={400}>{row.name}</Table.Th>
            <Table.Td>{row.left}</Table.Td>
            <Table.Td>{row.right}</Table.Td>
            <Table.Td>{row.norm}</Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}

function Predicted({ prediction }: { prediction: NonNullable<ResultDocument["prediction"]> }) {
  const { t, name, number, unit } = useI18n();
  return (
    <>
      <Title order={2}>{t("predictedChanges")}</Title>
      <Text>
        {Object.entries(prediction.request)
          .map(([quantity, value]) => [name(quantity), number(value, 2), unit(prediction.units[quantity] ?? "")].join(" "))
          .join(" · ")}
        {prediction.message && ` · ${prediction.message}`}
      </Text>
      <Table>
        <Table.Thead>
          <Table.Tr>
            <Table.Th>{t("quantity")}</Table.Th>
            <Table.Th>{t("identified")}</Table.Th>
            <Table.Th>{t("predicted")}</Table.Th>
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {Object.entries(prediction.identified).map(([quantity, value]) => (
            <Table.Tr key={quantity}>
              <Table.Th fw={400}>{name(quantity)}</Table.Th>
              <Table.Td>{number(value, digitsOf(quantity))}</Table.Td>
              <Table.Td>{number(prediction.predicted[quantity], digitsOf(quantity))}</Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </>
  );
}
