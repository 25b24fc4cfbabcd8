import { useMemo, useState } from "react";
import { Button, Group, NativeSelect, SegmentedControl, Stack, Text, Title } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import type { Schemas } from "../api/client";
import { PALETTES, useColours, usePalette, type Palette } from "../app/colours";
import { en } from "../i18n/en";
import { useI18n, type Key } from "../i18n/I18n";
import { CyclePanel, type Line, type PanelData } from "./CyclePanel";
import type { Cursor } from "./cursor";
import { stridesIn } from "./cycle";
import { useCycles, type Cycles } from "./cycles";
import { SIDES, type Band, type CurveSides, type ResultDocument } from "./document";
import { KINEMATICS, KINETICS, type PanelLayout } from "./panels";
import { ValuesModal } from "./ValuesModal";
import { VideoPane } from "./VideoPane";
import { ViewPane } from "./ViewPane";

interface Props {
  resultId: string;
  document: ResultDocument;
  cursor: Cursor;
  videos: readonly Schemas["Attachment"][];
}

export function CurvesTab({ resultId, document, cursor, videos }: Props) {
  const { t } = useI18n();
  const [view, setView] = useState("average");
  const [in3d, scene] = useDisclosure();
  const [inVideo, film] = useDisclosure();
  const axesOf = (words: string) => (AXES[words] ? t(AXES[words]) : words);
  const [picked, setPicked] = useState<PanelLayout | null>(null);
  const cycles = useCycles(resultId, document, view === "consistency");
  const strides = useMemo(() => stridesIn(document), [document]);
  const source = useMemo(() => panelSource(document, cycles, t), [document, cycles, t]);
  const panels = (layouts: readonly (PanelLayout | null)[]) =>
    layouts.map((layout, index) =>
      layout ? (
        <CyclePanel
          key={layout.name}
          layout={layout}
          data={source(layout.name)}
          cursor={cursor}
          onPick={() => setPicked(layout)}
        />
      ) : (
        !(in3d || inVideo) && <div key={index} className="hole" />
      ),
    );
  return (
    <Stack>
      <Group justify="space-between" className="no-print">
        <SegmentedControl
          aria-label={t("view")}
          value={view}
          onChange={setView}
          data={[
            { value: "average", label: t("average") },
            { value: "consistency", label: t("consistency") },
          ]}
        />
        <Group>
          <PaletteChoice />
          {videos.length > 0 && (
            <Button variant={inVideo ? "filled" : "default"} aria-pressed={inVideo} onClick={film.toggle}>
              {t("videoBeside")}
            </Button>
          )}
          <Button variant={in3d ? "filled" : "default"} aria-pressed={in3d} onClick={scene.toggle}>
            {t("beside3d")}
          </Button>
        </Group>
      </Group>
      <Legend document={document} />
      <div className={in3d || inVideo ? "with-view" : undefined}>
        <Stack>
          <div className="panels">{panels(KINEMATICS)}</div>
          {document.kinetics && (
            <>
              <Title order={2}>{t("kinetics")}</Title>
              <Text size="sm" c="dimmed">
                {t("momentsIn", { axes: axesOf(document.kinetics.moments_in) })}
              </Text>
              {document.kinetics.missing.map((sentence) => (
                <Text size="sm" key={sentence}>
                  {sentence}
                </Text>
              ))}
              <div className="panels">{panels(KINETICS)}</div>
            </>
          )}
          {document.emg && (
            <>
              <Title order={2}>{t("emg")}</Title>
              <Text size="sm" c="dimmed">
                {document.emg.filter}
              </Text>
              <div className="panels">{panels(emgLayouts(document.emg.envelopes))}</div>
            </>
          )}
        </Stack>
        {(in3d || inVideo) && (
          <div className="sticky">
            {in3d && <ViewPane resultId={resultId} strides={strides} cursor={cursor} />}
            {inVideo && <VideoPane videos={videos} strides={strides} cursor={cursor} />}
          </div>
        )}
      </div>
      <ValuesModal layout={picked} data={picked && source(picked.name)} onClose={() => setPicked(null)} />
    </Stack>
  );
}

/** Axes of the moments, as result.json words them. */
const AXES: Readonly<Record<string, Key>> = Object.fromEntries(
  (["axes_distal", "axes_proximal", "axes_joint", "axes_laboratory"] as const).map((key) => [en[key], key]),
);

function emgLayouts(envelopes: Readonly<Record<string, CurveSides>>): PanelLayout[] {
  return Object.entries(envelopes).map(([name, curve]) => {
    const peaks = SIDES.flatMap((side) => curve[side]?.mean ?? []).filter((value) => value !== null);
    return { name, scale: [0, 1.2 * Math.max(...peaks, 1e-9)], directions: ["", ""], unit: curve.unit ?? "" };
  });
}

type Sided = (key: Key) => string;

/** What each panel shows, by the curve's name. */
function panelSource(document: ResultDocument, cycles: Cycles | null, t: Sided): (name: string) => PanelData {
  const reference = document.scores?.reference;
  const norms: Record<string, Band> = { ...reference?.curves, ...reference?.kinetics };
  const curves = { ...document.kinematics, ...document.kinetics?.curves, ...document.emg?.envelopes };
  const footOff = {
    left: document.spatiotemporal.left?.mean.foot_off_percent ?? null,
    right: document.spatiotemporal.right?.mean.foot_off_percent ?? null,
  };
  const opposite = Object.fromEntries(
    SIDES.map((side) => {
      const mean = document.spatiotemporal[side]?.mean;
      return [side, [mean?.opposite_foot_off_percent ?? null, mean?.opposite_foot_strike_percent ?? null]];
    }),
  );
  const made = new Map<string, PanelData>();
  return (name) => {
    const known = made.get(name);
    if (known) return known;
    const lines = SIDES.flatMap((side): Line[] => {
      const single = cycles?.[name]?.[side];
      if (single) return single.map((mean, index) => ({ side, mean, faint: true, label: `${t(side)} ${index + 1}` }));
      const curve = curves[name]?.[side];
      return curve ? [{ side, mean: curve.mean, sd: curve.sd, label: t(side) }] : [];
    });
    const data: PanelData = { lines, norm: norms[name], footOff, opposite };
    made.set(name, data);
    return data;
  };
}

function PaletteChoice() {
  const { t } = useI18n();
  const [palette, setPalette] = usePalette();
  return (
    <NativeSelect
      aria-label={t("sideColours")}
      value={palette}
      onChange={(event) => setPalette(event.currentTarget.value as Palette)}
      data={PALETTES.map((value) => ({ value, label: t(`palette_${value}` as Key) }))}
    />
  );
}

function Legend({ document }: { document: ResultDocument }) {
  const { t } = useI18n();
  const colours = useColours();
  const cycles = (side: "left" | "right") => document.spatiotemporal[side]?.n_cycles ?? 0;
  return (
    <Text size="sm">
      {SIDES.map((side) => (
        <span key={side}>
          <b style={{ color: colours[side] }}>{t(side)}</b> ({t("cycleCount", { count: cycles(side) })}){" "}
        </span>
      ))}
      · {t("legendLines")} ·{" "}
      {document.scores?.reference ? t("normBand", { source: document.scores.reference.description }) : t("noNorms")}
    </Text>
  );
}
