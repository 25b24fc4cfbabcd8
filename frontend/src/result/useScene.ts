/** A running 3D session: what it tells and what it is told; time goes both ways between it and the curves. */
import { useEffect, useRef, useState } from "react";
import type { Schemas } from "../api/client";
import type { Cursor } from "./cursor";
import { percentAt, strideOf, timeAt, trialIn } from "./cycle";
import type { Side, Stride } from "./document";

export interface SceneState {
  trial: string;
  time: number;
  frame: number;
  phase: string;
  playing: boolean;
}

export type Command = Readonly<Record<string, unknown>>;
export type Order = (command: Command) => void;

export interface SceneProps {
  viewer: Schemas["Viewer"];
  strides: readonly Stride[];
  cursor: Cursor;
}

function tell(socket: WebSocket | null, command: Command): void {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(command));
}

/** The state that the scene tells, and the way to order something. */
export function useScene({ viewer, strides, cursor }: SceneProps, side: Side) {
  const [state, setState] = useState<SceneState | null>(null);
  const socket = useRef<WebSocket | null>(null);
  // True while the cursor follows the scene, so that it is not sent back.
  const following = useRef(false);
  const trial = useRef(viewer.trials[0] ?? "");

  useEffect(() => {
    const address = new URL(viewer.control, window.location.href);
    address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
    const opened = new WebSocket(address);
    socket.current = opened;
    opened.onmessage = (event: MessageEvent<string>) => {
      const told = JSON.parse(event.data) as SceneState;
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

  return { state, order: (command: Command) => tell(socket.current, command) };
}
