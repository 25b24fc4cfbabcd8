/** A video of the visit beside the curves, at the cursor's time; while it plays, it moves the cursor. */
import { useEffect, useRef, useState } from "react";
import { Group, NativeSelect, NumberInput, Paper, Text } from "@mantine/core";
import { useLocalStorage } from "@mantine/hooks";
import type { Schemas } from "../api/client";
import { useI18n } from "../i18n/I18n";
import type { Cursor } from "./cursor";
import { percentAt, strideOf, timeAt } from "./cycle";
import type { Stride } from "./document";

interface Props {
  videos: readonly Schemas["Attachment"][];
  strides: readonly Stride[];
  cursor: Cursor;
}

export function isVideo({ media_type, name }: Schemas["Attachment"]): boolean {
  return media_type.startsWith("video/") || /\.(mp4|webm|mov)$/i.test(name);
}

export function VideoPane({ videos, strides, cursor }: Props) {
  const { t } = useI18n();
  const player = useRef<HTMLVideoElement>(null);
  const [chosen, setChosen] = useState(videos[0]?.id ?? "");
  const [unplayable, setUnplayable] = useState("");
  const trials = [...new Set(strides.map((each) => each.trial))];
  const [trial, setTrial] = useState(trials[0] ?? "");
  // Camera and motion capture start at different times; nobody but the viewer knows how far apart.
  const [offset, setOffset] = useLocalStorage<number>({ key: `gaitlab-video-${chosen}-${trial}`, defaultValue: 0 });

  useEffect(() => {
    const stride = strideOf(strides, trial, "left") ?? strideOf(strides, trial, "right");
    return cursor.listen((percent) => {
      const video = player.current;
      if (!video || !video.paused || percent === null || !stride) return;
      video.currentTime = Math.max(0, timeAt(stride, percent) + offset);
    });
  }, [cursor, strides, trial, offset]);

  const follow = () => {
    const video = player.current;
    if (!video || video.paused) return;
    const time = video.currentTime - offset;
    cursor.move(percentAt(strides, trial, "left", time) ?? percentAt(strides, trial, "right", time), null);
  };
  return (
    <Paper withBorder p="sm" className="no-print">
      <video
        ref={player}
        controls
        muted
        playsInline
        aria-label={t("video")}
        src={`/api/v1/attachments/${chosen}/file`}
        onTimeUpdate={follow}
        onError={() => setUnplayable(chosen)}
        style={{ width: "100%", maxHeight: 420 }}
      />
      {unplayable === chosen && (
        <Text size="sm" role="alert">
          {t("videoUnplayable")}
        </Text>
      )}
      <Group gap="xs" mt="xs" align="end">
        {videos.length > 1 && (
          <NativeSelect
            size="xs"
            label={t("video")}
            value={chosen}
            onChange={(event) => setChosen(event.currentTarget.value)}
            data={videos.map(({ id, name }) => ({ value: id, label: name }))}
          />
        )}
        {trials.length > 1 && (
          <NativeSelect
            size="xs"
            label={t("trial")}
            value={trial}
            onChange={(event) => setTrial(event.currentTarget.value)}
            data={trials}
          />
        )}
        <NumberInput
          size="xs"
          label={t("videoOffset")}
          value={offset}
          step={0.04}
          decimalScale={2}
          onChange={(value) => setOffset(Number(value) || 0)}
        />
      </Group>
    </Paper>
  );
}
