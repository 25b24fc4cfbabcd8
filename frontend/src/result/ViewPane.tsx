/** The walk in 3D beside the curves; a session of the server lives as long as the pane. */
import { useEffect } from "react";
import { Button, Loader, Paper } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { client, changeHeaders, unwrap } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import type { Cursor } from "./cursor";
import type { Stride } from "./document";
import { Scene } from "./Scene";

interface Props {
  resultId: string;
  strides: readonly Stride[];
  cursor: Cursor;
}

/** A 3D session that lives as long as the pane. */
function useViewer(resultId: string) {
  const viewer = useQuery({
    queryKey: ["viewer", resultId],
    queryFn: () =>
      unwrap(client.POST("/api/v1/results/{result_id}/viewer", { params: { path: { result_id: resultId } } })),
    staleTime: Infinity,
    gcTime: 0,
    retry: false,
  });
  const id = viewer.data?.id;
  useEffect(() => {
    if (!id) return undefined;
    return () => void fetch(`/api/v1/viewers/${id}`, { method: "DELETE", headers: changeHeaders(), keepalive: true });
  }, [id]);
  return viewer;
}

export function ViewPane({ resultId, strides, cursor }: Props) {
  const { t } = useI18n();
  const viewer = useViewer(resultId);
  return (
    <Paper withBorder p="sm" className="no-print">
      <ErrorNote error={viewer.error} />
      {viewer.isPending && <Loader role="status" aria-label={t("opening3d")} />}
      {viewer.data && <Scene viewer={viewer.data} strides={strides} cursor={cursor} />}
      <Button component="a" mt="sm" size="xs" variant="default" href={`/api/v1/results/${resultId}/exports/scene`} download>
        {t("sceneAsFile")}
      </Button>
    </Paper>
  );
}
