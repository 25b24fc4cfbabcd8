import { useState } from "react";
import { Anchor, Badge, Button, Checkbox, Group, Paper, PasswordInput, SimpleGrid, Stack, Text, Title } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useAccount } from "../account/Account";
import { client, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { usePalette } from "../app/colours";
import { useI18n, type Key } from "../i18n/I18n";

type Page = NonNullable<Schemas["ReportContent"]["pages"]>[number];
const PAGES: Page[] = [
  "front", "examination", "kinematics", "consistency", "kinetics", "emg", "spatiotemporal", "scores", "weights", "walk",
  "stills", "quality", "provenance",
];
const LOOK_AGAIN_MS = 2_000;

const EXPORTS = ["json", "csv", "parquet", "npz", "c3d", "trc", "mot", "fhir"] as const;

export function ReportTab({ result }: { result: Schemas["Result"] }) {
  const { t } = useI18n();
  const { may } = useAccount();
  const session = result.session_id;
  const reports = useQuery({
    queryKey: ["reports", session],
    queryFn: () =>
      unwrap(client.GET("/api/v1/reports", { params: { query: { ...(session ? { session_id: session } : {}), limit: 50 } } })),
    enabled: may("reports:read"),
    refetchInterval: ({ state }) => (state.data?.items.some((each) => !each.has_pdf) ? LOOK_AGAIN_MS : false),
  });
  const mine = reports.data?.items.filter((each) => each.result_id === result.id) ?? [];
  return (
    <Stack maw={1000}>
      {may("reports:write") && <NewReport resultId={result.id} />}
      <ErrorNote error={reports.error} />
      {mine.map((report) => (
        <ReportCard key={report.id} report={report} />
      ))}
      <Title order={2}>{t("exports")}</Title>
      <Group>
        {EXPORTS.map((kind) => (
          <Anchor key={kind} href={`/api/v1/results/${result.id}/exports/${kind}`} download>
            {kind}
          </Anchor>
        ))}
      </Group>
    </Stack>
  );
}

function NewReport({ resultId }: { resultId: string }) {
  const { t } = useI18n();
  const queries = useQueryClient();
  const [palette] = usePalette();
  const [pages, setPages] = useState<readonly string[]>(PAGES);
  const create = useMutation({
    mutationFn: () =>
      unwrap(
        client.POST("/api/v1/reports", {
          body: {
            kind: "report",
            result_id: resultId,
            content: { pages: PAGES.filter((page) => pages.includes(page)), colours: palette },
          },
        }),
      ),
    onSuccess: () => queries.invalidateQueries({ queryKey: ["reports"] }),
  });
  return (
    <Paper withBorder p="md">
      <Checkbox.Group label={t("pages")} value={[...pages]} onChange={setPages}>
        <SimpleGrid cols={{ base: 2, md: 4 }} my="sm">
          {PAGES.map((page) => (
            <Checkbox key={page} value={page} label={t(`page_${page}` as Key)} />
          ))}
        </SimpleGrid>
      </Checkbox.Group>
      <ErrorNote error={create.error} />
      <Button disabled={pages.length === 0} loading={create.isPending} onClick={() => create.mutate()}>
        {t("buildReport")}
      </Button>
    </Paper>
  );
}

function ReportCard({ report }: { report: Schemas["Report"] }) {
  const { t, date } = useI18n();
  const { may } = useAccount();
  const file = `/api/v1/reports/${report.id}/file`;
  return (
    <Paper withBorder p="md" data-testid="report">
      <Group justify="space-between">
        <Group>
          <Text fw={600}>{t("reportVersion", { number: report.number })}</Text>
          <Text c="dimmed">{date(report.created_at)}</Text>
          {report.signatures.map((signature) => (
            <Badge key={signature.id} color="teal" variant="light">
              {t("signedBy", { name: signature.display_name })}
            </Badge>
          ))}
        </Group>
        {report.has_pdf ? (
          <Group>
            {report.has_html && (
              <Anchor href={`${file}.html`} target="_blank" rel="noreferrer">
                {t("preview")}
              </Anchor>
            )}
            <Anchor href={`${file}.pdf`} download>
              PDF
            </Anchor>
          </Group>
        ) : (
          <Text c="dimmed">{t("beingMade")}</Text>
        )}
      </Group>
      {report.has_pdf && may("reports:sign") && <Sign reportId={report.id} />}
    </Paper>
  );
}

function Sign({ reportId }: { reportId: string }) {
  const { t } = useI18n();
  const queries = useQueryClient();
  const [password, setPassword] = useState("");
  const sign = useMutation({
    mutationFn: () =>
      unwrap(
        client.POST("/api/v1/reports/{report_id}/signatures", {
          params: { path: { report_id: reportId } },
          body: { password, meaning: "author" },
        }),
      ),
    onSuccess: () => {
      setPassword("");
      return queries.invalidateQueries({ queryKey: ["reports"] });
    },
  });
  return (
    <>
      <Group align="end" mt="sm">
        <PasswordInput
          w={240}
          size="xs"
          label={t("passwordToSign")}
          autoComplete="current-password"
          value={password}
          onChange={(event) => setPassword(event.currentTarget.value)}
        />
        <Button size="xs" variant="default" loading={sign.isPending} onClick={() => sign.mutate()}>
          {t("sign")}
        </Button>
      </Group>
      <ErrorNote error={sign.error} />
    </>
  );
}
