/** Foot strikes and foot offs on a line of time, a row for each side; dragged, or moved by keys. */
import { useState, type KeyboardEvent, type PointerEvent } from "react";
import { Text } from "@mantine/core";
import { useElementSize } from "@mantine/hooks";
import { useColours } from "../app/colours";
import { useI18n } from "../i18n/I18n";
import type { CorrectedEvent } from "./events";
import { movedByKey, snapped, stancesOf, ticksOf, withTime, type TimeAxis } from "./timeAxis";

const SIDES = ["left", "right"] as const;
const ROW = 46;
const TOP = 18;
const BOTTOM = TOP + SIDES.length * ROW;
const HEIGHT = BOTTOM + 34;
/** Room for the names of the sides, and for half a mark at the right end. */
const [START, MARGIN] = [64, 24];
/** Half the width of what a finger takes hold of. */
const GRIP = 13;
/** A foot strike points down to the floor and is filled, a foot off points up and is hollow. */
const SHAPES = { foot_strike: "M-9,-8 L9,-8 L0,8 Z", foot_off: "M-9,8 L9,8 L0,-8 Z" } as const;

interface Props {
  events: readonly CorrectedEvent[];
  axis: TimeAxis;
  onChange: (events: CorrectedEvent[]) => void;
}

/** What is dragged, and how far the pointer is from its middle. */
interface Grabbed {
  index: number;
  offset: number;
}

export function TimeLine({ events, axis, onChange }: Props) {
  const { t } = useI18n();
  const { ref, width } = useElementSize();
  const [grabbed, setGrabbed] = useState<Grabbed | null>(null);
  const length = Math.max(width - START - MARGIN, 1);
  const place = (time: number) => START + (length * Math.min(Math.max(time, 0), axis.end)) / axis.end;
  const move = (index: number, time: number) => {
    if (time !== events[index]?.time_s) onChange(withTime(events, index, time));
  };
  const grab = (index: number, x: number) => (event: PointerEvent<SVGGElement>) => {
    event.currentTarget.setPointerCapture(event.pointerId);
    setGrabbed({ index, offset: event.clientX - x });
  };
  const drag = (event: PointerEvent<SVGGElement>) => {
    if (!grabbed) return;
    const x = event.clientX - grabbed.offset;
    move(grabbed.index, snapped(((x - START) / length) * axis.end, axis));
  };
  const press = (index: number, time: number) => (event: KeyboardEvent) => {
    const to = movedByKey(time, event.key, axis);
    if (to === null) return;
    event.preventDefault();
    move(index, to);
  };
  return (
    <div ref={ref}>
      <svg className="time-line" role="group" aria-label={t("timeLine")} width="100%" height={HEIGHT}>
        <Background events={events} axis={axis} place={place} />
        {events.map((event, index) => (
          <Mark
            key={index}
            number={index + 1}
            event={event}
            axis={axis}
            x={place(event.time_s)}
            onPointerDown={grab(index, place(event.time_s))}
            onPointerMove={drag}
            onPointerUp={() => setGrabbed(null)}
            onKeyDown={press(index, event.time_s)}
          />
        ))}
      </svg>
      <Text size="xs" c="dimmed">
        {t("timeLineHint")}
      </Text>
    </div>
  );
}

function middleOf(side: CorrectedEvent["side"]): number {
  return TOP + ROW * (SIDES.indexOf(side) + 0.5);
}

interface BackgroundProps {
  events: readonly CorrectedEvent[];
  axis: TimeAxis;
  place: (time: number) => number;
}

/** Axis in seconds, names of the rows, and bars where a foot is on the floor. */
function Background({ events, axis, place }: BackgroundProps) {
  const { t, name, plain } = useI18n();
  const colours = useColours();
  return (
    <g aria-hidden>
      {ticksOf(axis).map((time) => (
        <g key={time} transform={`translate(${place(time)},0)`}>
          <line y1={TOP} y2={BOTTOM} stroke={colours.grid} />
          <text y={BOTTOM + 14} textAnchor="middle" fill={colours.text}>
            {plain(time)}
          </text>
        </g>
      ))}
      <text x={place(axis.end / 2)} y={HEIGHT - 4} textAnchor="middle" fill={colours.text}>
        {t("time")} [s]
      </text>
      {SIDES.map((side) => (
        <g key={side}>
          <text y={middleOf(side) + 4} fill={colours[side]} fontWeight={700}>
            {name(side)}
          </text>
          <line x1={place(0)} x2={place(axis.end)} y1={middleOf(side)} y2={middleOf(side)} stroke={colours.text} />
          {stancesOf(events, side, axis).map(([from, to]) => (
            <rect
              key={from}
              x={place(from)}
              width={Math.max(place(to) - place(from), 0)}
              y={middleOf(side) - 5}
              height={10}
              fill={colours[side]}
              opacity={0.3}
            />
          ))}
        </g>
      ))}
    </g>
  );
}

interface MarkProps {
  number: number;
  event: CorrectedEvent;
  axis: TimeAxis;
  x: number;
  onPointerDown: (event: PointerEvent<SVGGElement>) => void;
  onPointerMove: (event: PointerEvent<SVGGElement>) => void;
  onPointerUp: () => void;
  onKeyDown: (event: KeyboardEvent) => void;
}

/** One event, to take hold of. */
function Mark({ number: row, event, axis, x, onPointerUp, ...handlers }: MarkProps) {
  const { t, name, number } = useI18n();
  const colours = useColours();
  const { side, kind, time_s } = event;
  const time = t("seconds", { value: number(time_s, 3) });
  return (
    <g
      className="mark"
      role="slider"
      tabIndex={0}
      aria-label={`${name(kind)} ${name(side).toLowerCase()}, ${row}`}
      aria-valuemin={0}
      aria-valuemax={axis.end}
      aria-valuenow={time_s}
      aria-valuetext={`${time}, ${t("frame", { number: Math.round(time_s / axis.frame) })}`}
      transform={`translate(${x},${middleOf(side)})`}
      onPointerUp={onPointerUp}
      onPointerCancel={onPointerUp}
      {...handlers}
    >
      <rect className="grip" x={-GRIP} y={-GRIP} width={2 * GRIP} height={2 * GRIP} rx={4} />
      <path
        d={SHAPES[kind]}
        stroke={colours[side]}
        strokeWidth={2}
        strokeLinejoin="round"
        fill={kind === "foot_strike" ? colours[side] : "var(--mantine-color-body)"}
      />
      <text className="value" y={-GRIP - 2} textAnchor="middle" fill={colours.text} aria-hidden>
        {time}
      </text>
    </g>
  );
}
