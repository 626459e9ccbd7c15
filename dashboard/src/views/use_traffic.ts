// The stream of frames, into a log that is shown a few times a second however many come.
import { useEffect, useRef, useState } from "preact/hooks";

import type { TrafficMessage } from "../api";
import { closeSocket } from "../close_socket";
import { useWorld } from "../hooks";
import { TrafficLog } from "../traffic_log";

const kRetry = 1000; // ms
const kShowEvery = 200; // ms

export interface Wanted {
  readonly networks: readonly string[];
  readonly filter: string;
}

export interface Traffic {
  readonly log: TrafficLog;
  /// Frames that came to the rack's networks and not to this page.
  readonly lost: number;
  readonly problem: string;
  readonly clear: () => void;
}

export function useTraffic(wanted: Wanted, paused: boolean): Traffic {
  const { api } = useWorld();
  const log = useRef(new TrafficLog());
  const lost = useRef(0);
  /// The server counts from the begin of a connection on.
  const lostBefore = useRef(0);
  const [problem, setProblem] = useState("");
  const [, render] = useState({});
  const socket = useRef<WebSocket | null>(null);
  const message = JSON.stringify({ ...wanted, frames: true });
  const latest = useRef(message);
  latest.current = message;
  useEffect(() => {
    if (paused) {
      return undefined;
    }
    let ended = false;
    let retry: ReturnType<typeof setTimeout> | undefined;
    let showing: ReturnType<typeof setTimeout> | undefined;
    const open = () => {
      const opened = api.socket("/api/v1/traffic");
      socket.current = opened;
      lostBefore.current = lost.current;
      opened.onopen = () => opened.send(latest.current);
      opened.onmessage = (event: MessageEvent<string>) => {
        const taken = JSON.parse(event.data) as TrafficMessage;
        if (taken.type === "problem") {
          setProblem(taken.problem.detail);
        } else if (taken.type === "frames") {
          setProblem("");
          lost.current = lostBefore.current + taken.dropped;
          log.current.take(taken.frames);
          showing ??= setTimeout(() => {
            showing = undefined;
            render({});
          }, kShowEvery);
        }
      };
      opened.onclose = () => {
        if (!ended) {
          retry = setTimeout(open, kRetry);
        }
      };
    };
    open();
    return () => {
      ended = true;
      clearTimeout(retry);
      clearTimeout(showing);
      closeSocket(socket.current);
      socket.current = null;
      render({});
    };
  }, [api, paused]);
  useEffect(() => {
    if (socket.current?.readyState === WebSocket.OPEN) {
      socket.current.send(message);
    }
  }, [message]);
  const clear = () => {
    log.current = new TrafficLog();
    lostBefore.current -= lost.current;
    lost.current = 0;
    render({});
  };
  return { log: log.current, lost: lost.current, problem, clear };
}
