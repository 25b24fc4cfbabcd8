/** Saved sets of results: opened, kept, removed. */
import { useState } from "react";
import { Button, Group, NativeSelect, Text, TextInput } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useAccount } from "../account/Account";
import { client, ifMatch, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { submitting } from "../app/submitting";
import { useI18n } from "../i18n/I18n";

const KEY = ["cohorts"];

interface Props {
  chosen: readonly string[];
  choose: (ids: readonly string[]) => void;
}

export function Cohorts({ chosen, choose }: Props) {
  const { t } = useI18n();
  const { may } = useAccount();
  const queries = useQueryClient();
  const [opened, setOpened] = useState("");
  const [name, setName] = useState("");
  const refresh = () => queries.invalidateQueries({ queryKey: KEY });
  const cohorts = useQuery({
    queryKey: KEY,
    queryFn: () => unwrap(client.GET("/api/v1/cohorts", { params: { query: { limit: 100 } } })),
  });
  const open = useMutation({
    mutationFn: (id: string) => unwrap(client.GET("/api/v1/cohorts/{cohort_id}", { params: { path: { cohort_id: id } } })),
    onSuccess: (cohort) => choose(cohort.members.map((each) => each.result_id)),
  });
  const members = chosen.map((id) => ({ result_id: id, group: "" }));
  const keep = useMutation({
    mutationFn: () => unwrap(client.POST("/api/v1/cohorts", { body: { name, members } })),
    onSuccess: (cohort) => {
      setName("");
      setOpened(cohort.id);
      return refresh();
    },
  });
  const present = cohorts.data?.items.find((each) => each.id === opened);
  const replace = useMutation({
    mutationFn: () => {
      const params = { path: { cohort_id: opened }, header: ifMatch(present?.version ?? 0) };
      return unwrap(client.PATCH("/api/v1/cohorts/{cohort_id}", { params, body: { members } }));
    },
    onSettled: refresh,
  });
  return (
    <>
      <Group align="end" className="no-print">
        <NativeSelect
          label={t("cohort")}
          value={opened}
          onChange={(event) => {
            setOpened(event.currentTarget.value);
            if (event.currentTarget.value) open.mutate(event.currentTarget.value);
          }}
          data={[
            { value: "", label: "–" },
            ...(cohorts.data?.items ?? []).map((each) => ({ value: each.id, label: `${each.name} (${each.n_members})` })),
          ]}
        />
        {may("cohorts:write") && present && (
          <Button variant="default" loading={replace.isPending} onClick={() => replace.mutate()}>
            {t("replaceCohort")}
          </Button>
        )}
        {may("cohorts:write") && chosen.length > 0 && (
          <form onSubmit={submitting(keep.mutate)}>
            <Group align="end">
              <TextInput
                label={t("newCohort")}
                required
                value={name}
                onChange={(event) => setName(event.currentTarget.value)}
              />
              <Button type="submit" variant="default" loading={keep.isPending}>
                {t("save")}
              </Button>
            </Group>
          </form>
        )}
        {keep.isSuccess && <Text role="status">{t("cohortKept")}</Text>}
      </Group>
      <ErrorNote error={cohorts.error ?? open.error ?? keep.error ?? replace.error} />
    </>
  );
}
