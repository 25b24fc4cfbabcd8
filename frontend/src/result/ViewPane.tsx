/** The walk in 3D beside the curves; time goes both ways. */
import { useEffect, useRef, useState } from "react";
import { Button, Group, Loader, NativeSelect, Paper, SegmentedControl, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { client, changeHeaders, unwrap, type Schemas } from "../api/client";
import { ErrorNote } from "../app/ErrorNote";
import { useI18n } from "../i18n/I18n";
import type { Cursor } from "./cursor";
import { percentAt, strideOf, timeAt, trialIn } from "./cycle";
import { SIDES, type Side, type Stride } from "./document";

interface Props {
  resultId: string;
  strides: readonly Stride[];
  cursor: Cursor;
}

interface State {
  trial: string;
  time: number;
  frame: number;
  phase: string;
  playing: boolean;
}

type Command = Readonly<Record<string, unknown>>;

function tell(socket: WebSocket | null, command: Command): void {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(command));
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
    <Paper withBorder p="sm" className="sticky no-print" style={{ alignSelf: "start" }}>
      <ErrorNote error={viewer.error} />
      {viewer.isPending && <Loader aria-label={t("opening3d")} />}
      {viewer.data && <Scene viewer={viewer.data} strides={strides} cursor={cursor} />}
      <Button component="a" mt="sm" size="xs" variant="default" href={`/api/v1/results/${resultId}/exports/scene`} download>
        {t("sceneAsFile")}
      </Button>
    </Paper>
  );
}

function Scene({ viewer, strides, cursor }: { viewer: Schemas["Viewer"]; strides: readonly Stride[]; cursor: Cursor }) {
  const { t, number } = useI18n();
  const [state, setState] = useState<State | null>(null);
  const [side, setSide] = useState<Side>("left");
  const socket = useRef<WebSocket | null>(null);
  // True while the cursor follows the scene, so that it is not sent back.
  const following = useRef(false);
  const trial = useRef(viewer.trials[0] ?? "");
  const order = (command: Command) => tell(socket.current, command);

  useEffect(() => {
    const address = new URL(viewer.control, window.location.href);
    address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
    const opened = new WebSocket(address);
    socket.current = opened;
    opened.onmessage = (event: MessageEvent<string>) => {
      const told = JSON.parse(event.data) as State;
      trial.current = told.trial;
      setState(told);
      // A scene that stands only echoes what the cursor asked for.
      if (!told.playing) return;
      following.current = true;
      cursor.move(percentAt(strides, trialIn(strides, told.trial), side, told.time), null);
      following.current = false;
    };
    const leave = cursor.listen((percent) => {
      const stride = strideOf(strides, trialIn(strides, trial.current), side);
      if (following.current || percent === null || !stride) return;
      tell(opened, { seek: timeAt(stride, percent) });
    });
    return () => {
      leave();
      opened.close();
    };
  }, [viewer.control, strides, cursor, side]);

  return (
    <Stack gap="xs">
      <iframe className="view-frame" title={t("scene3d")} src={viewer.url} />
      <Group gap="xs">
        <Button size="xs" aria-pressed={state?.playing ?? false} onClick={() => order({ play: !state?.playing })}>
          {t(state?.playing ? "pause" : "play")}
        </Button>
        <NativeSelect
          size="xs"
          aria-label={t("speed")}
          onChange={(event) => order({ speed: Number(event.currentTarget.value) })}
          defaultValue="1"
          data={["0.1", "0.25", "0.5", "1"].map((value) => ({ value, label: `${value} ×` }))}
        />
        {(["sagittal", "frontal"] as const).map((view) => (
          <Button key={view} size="xs" variant="default" onClick={() => order({ look: view })}>
            {t(view)}
          </Button>
        ))}
      </Group>
      {viewer.trials.length > 1 && (
        <NativeSelect
          size="xs"
          label={t("trial")}
          data={[...viewer.trials]}
          onChange={(event) => order({ select: event.currentTarget.value })}
        />
      )}
      <SegmentedControl
        size="xs"
        aria-label={t("cycleOf")}
        value={side}
        onChange={(value) => setSide(value as Side)}
        data={SIDES.map((value) => ({ value, label: t(value) }))}
      />
      <Text size="sm" data-testid="frame" data-frame={state?.frame}>
        {state && `${number(state.time, 2)} s · ${t("frame", { number: state.frame })} ${state.phase}`}
      </Text>
    </Stack>
  );
}
