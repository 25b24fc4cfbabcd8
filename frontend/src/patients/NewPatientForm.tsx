import { useState, type FormEvent } from "react";
import { Button, Group, Modal, NativeSelect, Stack, TextInput } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useLocation } from "wouter";
import { client, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";

type Sex = NonNullable<Schemas["NewPatient"]["sex"]>;

export function NewPatientForm({ opened, onClose }: { opened: boolean; onClose: () => void }) {
  const { t } = useI18n();
  const queries = useQueryClient();
  const [, navigate] = useLocation();
  const [pseudonym, setPseudonym] = useState("");
  const [sex, setSex] = useState<Sex>("");
  const [diagnosis, setDiagnosis] = useState("");
  const create = useMutation({
    mutationFn: () => unwrap(client.POST("/api/v1/patients", { body: { pseudonym, sex, diagnosis } })),
    onSuccess: (patient) => {
      void queries.invalidateQueries({ queryKey: ["patients"] });
      navigate(`/patients/${patient.id}`);
    },
  });
  const submit = (event: FormEvent) => {
    event.preventDefault();
    create.mutate();
  };
  return (
    <Modal opened={opened} onClose={onClose} title={t("newPatient")} closeButtonProps={{ "aria-label": t("close") }}>
      <form onSubmit={submit}>
        <Stack>
          <TextInput
            label={t("pseudonym")}
            description={t("pseudonymHint")}
            required
            data-autofocus
            value={pseudonym}
            onChange={(event) => setPseudonym(event.currentTarget.value)}
          />
          <NativeSelect
            label={t("sex")}
            value={sex}
            onChange={(event) => setSex(event.currentTarget.value as Sex)}
            data={[
              { value: "", label: "–" },
              { value: "female", label: t("female") },
              { value: "male", label: t("male") },
              { value: "other", label: t("otherSex") },
            ]}
          />
          <TextInput
            label={t("diagnosis")}
            value={diagnosis}
            onChange={(event) => setDiagnosis(event.currentTarget.value)}
          />
          <ErrorNote error={create.error} />
          <Group justify="end">
            <Button type="submit" loading={create.isPending}>
              {t("save")}
            </Button>
          </Group>
        </Stack>
      </form>
    </Modal>
  );
}
