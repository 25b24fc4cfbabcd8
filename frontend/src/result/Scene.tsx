/** The 3D view with its controls. */
import { useRef, useState, type RefObject } from "react";
import {
  Button,
  Chip,
  Group,
  NativeSelect,
  SegmentedControl,
  Stack,
  Switch,
  Text,
  useComputedColorScheme,
} from "@mantine/core";
import { useI18n } from "../i18n/I18n";
import { record, saveStill } from "./capture";
import { SIDES, type Side } from "./document";
import { useScene, type Order, type SceneProps, type SceneState } from "./useScene";

const LAYERS = [
  "markers",
  "measured",
  "model-optimal",
  "plate forces",
  "model forces",
  "pressure centre",
  "centre of mass",
  "trails",
  "floor",
] as const;
const VIEWS = ["sagittal", "frontal", "oblique"] as const;
/** As in style.css: viser gives narrow pages a panel over half the scene. */
const ENLARGED = 1.5;
const SPEEDS = ["0.1", "0.25", "0.5", "1"];

export function Scene(props: SceneProps) {
  const { viewer } = props;
  const { t, name, number } = useI18n();
  const scheme = useComputedColorScheme("light");
  const [side, setSide] = useState<Side>("left");
  const frame = useRef<HTMLIFrameElement>(null);
  const { state, order } = useScene(props, side);
  return (
    <Stack gap="xs">
      <div className="view-place">
        <iframe ref={frame} className="view-frame" title={t("scene3d")} src={addressOf(viewer.url, scheme)} />
      </div>
      <Playback state={state} order={order} />
      <Group gap="xs">
        {VIEWS.map((view) => (
          <Button key={view} size="xs" variant="default" onClick={() => order({ look: view })}>
            {t(view)}
          </Button>
        ))}
      </Group>
      <Layers order={order} />
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
        {state &&
          [`${number(state.time, 2)} s`, t("frame", { number: state.frame }), state.phase && name(state.phase)]
            .filter(Boolean)
            .join(" · ")}
      </Text>
      <Capture frame={frame} order={order} state={state} />
    </Stack>
  );
}

function Playback({ state, order }: { state: SceneState | null; order: Order }) {
  const { t, plain } = useI18n();
  return (
    <Group gap="xs">
      <Button size="xs" aria-pressed={state?.playing ?? false} onClick={() => order({ play: !state?.playing })}>
        {t(state?.playing ? "pause" : "play")}
      </Button>
      <NativeSelect
        size="xs"
        aria-label={t("speed")}
        onChange={(event) => order({ speed: Number(event.currentTarget.value) })}
        defaultValue="1"
        data={SPEEDS.map((value) => ({ value, label: `${plain(Number(value))} ×` }))}
      />
      <Switch
        size="xs"
        label={t("followPelvis")}
        defaultChecked
        onChange={(event) => order({ follow: event.currentTarget.checked })}
      />
    </Group>
  );
}

function Layers({ order }: { order: Order }) {
  const { t, name } = useI18n();
  return (
    <Chip.Group multiple defaultValue={[...LAYERS]}>
      <Group gap={6} role="group" aria-label={t("layers")}>
        {LAYERS.map((layer) => (
          <Chip
            key={layer}
            value={layer}
            size="xs"
            onChange={(shown) => order(shown ? { show: layer } : { hide: layer })}
          >
            {name(layer.replace(/[- ]/g, "_"))}
          </Chip>
        ))}
      </Group>
    </Chip.Group>
  );
}

/** viser's page as this page wants it: as dark, and with as many pixels although it is drawn larger and scaled down. */
function addressOf(url: string, scheme: string): string {
  const wishes = new URLSearchParams({ fixedDpr: String(devicePixelRatio / ENLARGED) });
  if (scheme === "dark") wishes.set("darkMode", "");
  return `${url}?${wishes}`;
}

interface CaptureProps {
  frame: RefObject<HTMLIFrameElement | null>;
  order: Order;
  state: SceneState | null;
}

function Capture({ frame, order, state }: CaptureProps) {
  const { t } = useI18n();
  const [stop, setStop] = useState<(() => void) | null>(null);
  const name = `${state?.trial ?? "walk"}-${state?.frame ?? 0}`;
  const toggle = () => {
    if (!stop) {
      const end = record(frame.current, name);
      setStop(() => end);
      return order({ play: true });
    }
    stop();
    setStop(null);
    order({ play: false });
  };
  const still = () => {
    // A layer that goes and comes makes the scene draw anew and leaves it as it was.
    const redraw = () => {
      order({ hide: "floor" });
      order({ show: "floor" });
    };
    void saveStill(frame.current, name, redraw);
  };
  return (
    <Group gap="xs">
      <Button size="xs" variant="default" onClick={still}>
        {t("saveStill")}
      </Button>
      <Button size="xs" variant="default" aria-pressed={stop !== null} onClick={toggle}>
        {t(stop ? "stopRecording" : "recordVideo")}
      </Button>
    </Group>
  );
}
