import { Table } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { client, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n, type Key } from "../i18n/I18n";

const REFRESH_MS = 5_000;
const MEGABYTE = 1e6;

export function SystemState() {
  const { t, number } = useI18n();
  const state = useQuery({
    queryKey: ["system"],
    queryFn: () => unwrap(client.GET("/api/v1/system")),
    refetchInterval: REFRESH_MS,
  });
  if (!state.data) return <ErrorNote error={state.error} />;
  const { data } = state;
  const rows: [string, string | number][] = [
    [t("version"), data.version],
    [t("workers"), data.workers.length],
    [t("scenes"), data.viewers],
    [t("database"), `${number(data.database_bytes / MEGABYTE)} MB`],
    [t("files"), `${data.files}, ${number(data.file_bytes / MEGABYTE)} MB`],
    ...Object.entries(data.jobs).map(([status, count]): [string, number] => [
      `${t("jobs")}: ${t(`status_${status}` as Key)}`,
      count ?? 0,
    ]),
  ];
  return (
    <Table maw={600}>
      <Table.Tbody>
        {rows.map(([title, value]) => (
          <Table.Tr key={title}>
            <Table.Th>{title}</Table.Th>
            <Table.Td>{value}</Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}
