import { useState } from "react";
import { NativeSelect, TextInput } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useLocation } from "wouter";
import { client, unwrap, type Schemas } from "../api/client";
import { FormDialog } from "../app/FormDialog";
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
  return (
    <FormDialog title={t("newPatient")} opened={opened} onClose={onClose} save={create}>
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
    </FormDialog>
  );
}
