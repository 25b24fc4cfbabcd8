import { useState } from "react";
import { NativeSelect, NumberInput, TextInput } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useLocation } from "wouter";
import { client, unwrap, type Schemas } from "../api/client";
import { FormDialog } from "../app/FormDialog";
import { useI18n } from "../i18n/I18n";

type Stage = Schemas["TreatmentStage"];

interface Props {
  patientId: string;
  opened: boolean;
  onClose: () => void;
}

export function NewVisitForm({ patientId, opened, onClose }: Props) {
  const { t } = useI18n();
  const queries = useQueryClient();
  const [, navigate] = useLocation();
  const [day, setDay] = useState(() => new Date().toISOString().slice(0, 10));
  const [condition, setCondition] = useState("");
  const [treatment, setTreatment] = useState("");
  const [stage, setStage] = useState<Stage>("none");
  const [age, setAge] = useState<string | number>("");
  const create = useMutation({
    mutationFn: () =>
      unwrap(
        client.POST("/api/v1/patients/{patient_id}/sessions", {
          params: { path: { patient_id: patientId } },
          body: { visited_on: day, condition, treatment, stage, age_years: age === "" ? null : Number(age) },
        }),
      ),
    onSuccess: (visit) => {
      void queries.invalidateQueries({ queryKey: ["visits"] });
      navigate(`/visits/${visit.id}`);
    },
  });
  return (
    <FormDialog title={t("newVisit")} opened={opened} onClose={onClose} save={create}>
      <TextInput
        type="date"
        label={t("visitedOn")}
        required
        value={day}
        onChange={(event) => setDay(event.currentTarget.value)}
      />
      <TextInput
        label={t("condition")}
        placeholder={t("conditionHint")}
        value={condition}
        onChange={(event) => setCondition(event.currentTarget.value)}
      />
      <NativeSelect
        label={t("stage")}
        value={stage}
        onChange={(event) => setStage(event.currentTarget.value as Stage)}
        data={[
          { value: "none", label: "–" },
          { value: "before", label: t("before") },
          { value: "after", label: t("after") },
        ]}
      />
      <TextInput
        label={t("treatment")}
        value={treatment}
        onChange={(event) => setTreatment(event.currentTarget.value)}
      />
      <NumberInput label={t("age")} min={0} max={130} value={age} onChange={setAge} />
    </FormDialog>
  );
}
