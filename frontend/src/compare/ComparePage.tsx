import { useMemo, useState } from "react";
import { Checkbox, Group, Stack, Table, Text, Title } from "@mantine/core";
import { useQueries, useQuery } from "@tanstack/react-query";
import { useLocation, useSearch } from "wouter";
import { client, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import { CyclePanel, type Line, type PanelData } from "../result/CyclePanel";
import { Cursor } from "../result/cursor";
import { SIDES, type ResultDocument } from "../result/document";
import { KINEMATICS, KINETICS } from "../result/panels";
import { SortableTable } from "./SortableTable";

/** Line styles of the sessions, in the order in which they were chosen. */
const DASHES: (number[] | undefined)[] = [undefined, [8, 4], [2, 3], [10, 3, 2, 3]];
const FEW = DASHES.length;

export default function ComparePage() {
  const { t } = useI18n();
  const [, navigate] = useLocation();
  const search = new URLSearchParams(useSearch());
  const chosen = (search.get("results") ?? "").split(",").filter(Boolean);
  const choose = (ids: readonly string[]) => navigate(`/compare?results=${ids.join(",")}`, { replace: true });
  return (
    <Stack>
      <Title order={1}>{t("compare")}</Title>
      <Choice chosen={chosen} choose={choose} />
      {chosen.length > 1 && <Tables ids={chosen} />}
      {chosen.length > 1 && chosen.length <= FEW && <Overlays ids={chosen} />}
    </Stack>
  );
}

function labelOf(result: Schemas["Result"], date: (iso: string) => string): string {
  const trials = result.summary.trials as string[] | undefined;
  return `${date(result.created_at)} ${trials?.join(", ") ?? ""}`;
}

function Choice({ chosen, choose }: { chosen: readonly string[]; choose: (ids: readonly string[]) => void }) {
  const { t, date } = useI18n();
  const results = useQuery({
    queryKey: ["results", "all"],
    queryFn: () => unwrap(client.GET("/api/v1/results", { params: { query: { kind: "analyse", limit: 100 } } })),
  });
  const patients = useQuery({
    queryKey: ["patients", "names"],
    queryFn: () => unwrap(client.GET("/api/v1/patients", { params: { query: { limit: 100 } } })),
  });
  const pseudonyms = new Map(patients.data?.items.map((each) => [each.id, each.pseudonym]));
  return (
    <details open={chosen.length < 2}>
      <summary>{t("chooseResults", { count: chosen.length })}</summary>
      <ErrorNote error={results.error} />
      <Table mt="xs">
        <Table.Tbody>
          {results.data?.items.map((result) => (
            <Table.Tr key={result.id}>
              <Table.Td>
                <Checkbox
                  label={`${pseudonyms.get(result.patient_id ?? "") ?? ""} · ${labelOf(result, date)}`}
                  checked={chosen.includes(result.id)}
                  onChange={() =>
                    choose(
                      chosen.includes(result.id) ? chosen.filter((id) => id !== result.id) : [...chosen, result.id],
                    )
                  }
                />
              </Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
      {results.data?.items.length === 0 && <Text c="dimmed">{t("noResults")}</Text>}
    </details>
  );
}

function Tables({ ids }: { ids: readonly string[] }) {
  const { t } = useI18n();
  const comparison = useQuery({
    queryKey: ["comparison", ids],
    queryFn: () =>
      unwrap(
        client.POST("/api/v1/comparisons", {
          body: { members: ids.map((id) => ({ result_id: id, group: "" })), tables: ["quantities", "weights"] },
        }),
      ),
  });
  const names = new Map(ids.map((id, index) => [id, String.fromCharCode(65 + (index % 26)) + (index >= 26 ? index : "")]));
  return (
    <>
      <ErrorNote error={comparison.error} />
      {comparison.data?.problems.map((problem) => (
        <Text key={problem} size="sm">
          {problem}
        </Text>
      ))}
      <Group gap="xs">
        {[...names].map(([id, letter]) => (
          <Text key={id} size="sm">
            <b>{letter}</b> {id.slice(0, 8)}
          </Text>
        ))}
      </Group>
      {Object.entries(comparison.data?.tables ?? {}).map(([title, table]) => (
        <div key={title}>
          <Title order={2}>{t(title === "weights" ? "weights" : "numbers")}</Title>
          <SortableTable name={title} table={table} labels={names} />
        </div>
      ))}
    </>
  );
}

function Overlays({ ids }: { ids: readonly string[] }) {
  const { t } = useI18n();
  const cursor = useMemo(() => new Cursor(), []);
  const [kinetics, setKinetics] = useState(false);
  const documents = useQueries({
    queries: ids.map((id) => ({
      queryKey: ["document", id],
      queryFn: () =>
        unwrap(client.GET("/api/v1/results/{result_id}/document", { params: { path: { result_id: id } } })).then(
          (told) => told as unknown as ResultDocument,
        ),
      staleTime: Infinity,
    })),
    combine: (all) => all.flatMap(({ data }) => (data ? [data] : [])),
  });
  const panels = useMemo(() => {
    const layouts = kinetics ? KINETICS : KINEMATICS;
    return layouts.map((layout) => layout && { layout, data: overlay(layout.name, documents, t("left"), t("right")) });
  }, [documents, kinetics, t]);
  if (documents.length < ids.length) return null;
  return (
    <>
      <Group justify="space-between">
        <Title order={2}>{t("curves")}</Title>
        <Checkbox label={t("kinetics")} checked={kinetics} onChange={(event) => setKinetics(event.currentTarget.checked)} />
      </Group>
      <Text size="sm">{t("overlayLegend")}</Text>
      <div className="panels">
        {panels.map((panel, index) =>
          panel ? (
            <CyclePanel key={panel.layout.name} layout={panel.layout} data={panel.data} cursor={cursor} />
          ) : (
            <div key={index} />
          ),
        )}
      </div>
    </>
  );
}

/** One curve of several sessions: colour is side, line style is session. */
function overlay(name: string, documents: readonly ResultDocument[], left: string, right: string): PanelData {
  const words = { left, right };
  const lines = documents.flatMap((document, index) =>
    SIDES.flatMap((side): Line[] => {
      const curve = (document.kinematics[name] ?? document.kinetics?.curves[name])?.[side];
      const dash = DASHES[index];
      const label = `${String.fromCharCode(65 + index)} ${words[side]}`;
      return curve ? [{ side, mean: curve.mean, label, ...(dash ? { dash } : {}) }] : [];
    }),
  );
  const reference = documents[0]?.scores?.reference;
  return { lines, norm: reference?.curves[name] ?? reference?.kinetics?.[name], footOff: {} };
}
