import { useEffect, useMemo, useRef, useState } from "preact/hooks";

import type { Frame, TrafficMessage } from "../api";
import { hexDump } from "../hex_dump";
import { timeText } from "../format";
import { useStore, useWorld } from "../hooks";

const kMostKept = 5000;
const kMostShown = 400;
const kRetry = 1000;

interface Wanted {
  readonly networks: readonly string[];
  readonly filter: string;
}

function useTraffic(wanted: Wanted, paused: boolean) {
  const { api } = useWorld();
  const [frames, setFrames] = useState<readonly Frame[]>([]);
  const [dropped, setDropped] = useState(0);
  const [problem, setProblem] = useState("");
  const socket = useRef<WebSocket | null>(null);
  const message = JSON.stringify({ ...wanted, frames: true });
  const latest = useRef(message);
  latest.current = message;
  useEffect(() => {
    if (paused) {
      return undefined;
    }
    let ended = false;
    let timer: ReturnType<typeof setTimeout> | undefined;
    let waiting: Frame[] = [];
    let drawing = 0;
    const open = () => {
      const opened = api.socket("/api/v1/traffic");
      socket.current = opened;
      opened.onopen = () => opened.send(latest.current);
      opened.onmessage = (event: MessageEvent<string>) => {
        const taken = JSON.parse(event.data) as TrafficMessage;
        if (taken.type === "problem") {
          setProblem(taken.problem.detail);
        } else if (taken.type === "frames") {
          setProblem("");
          setDropped((n) => n + taken.dropped);
          waiting.push(...taken.frames);
          drawing ||= requestAnimationFrame(() => {
            drawing = 0;
            const fresh = waiting;
            waiting = [];
            setFrames((old) => [...old, ...fresh].slice(-kMostKept));
          });
        }
      };
      opened.onclose = () => {
        if (!ended) {
          timer = setTimeout(open, kRetry);
        }
      };
    };
    open();
    return () => {
      ended = true;
      clearTimeout(timer);
      cancelAnimationFrame(drawing);
      socket.current?.close();
      socket.current = null;
    };
  }, [api, paused]);
  useEffect(() => {
    if (socket.current?.readyState === WebSocket.OPEN) {
      socket.current.send(message);
    }
  }, [message]);
  const clear = () => {
    setFrames([]);
    setDropped(0);
  };
  return { frames, dropped, problem, clear };
}

const kArrows: Readonly<Record<string, string>> = { request: "→", answer: "←", bus: "•" };

export function TrafficView() {
  const { rack } = useStore();
  const [network, setNetwork] = useState("");
  const [filter, setFilter] = useState("");
  const [paused, setPaused] = useState(false);
  const [chosen, setChosen] = useState<Frame | null>(null);
  const { frames, dropped, problem, clear } = useTraffic({ networks: network === "" ? [] : [network], filter }, paused);
  const shown = useMemo(() => {
    const words = filter.toLowerCase();
    return frames
      .filter((frame) => network === "" || frame.network === network)
      .filter((frame) => `${frame.summary} ${frame.fields.flat().join(" ")}`.toLowerCase().includes(words))
      .slice(-kMostShown)
      .reverse();
  }, [frames, filter, network]);
  return (
    <>
      <div class="view-head">
        <h1>Traffic</h1>
        <span class="soft">What masters and devices send, decoded; the newest first</span>
      </div>
      <div class="traffic">
        <section class="panel">
          <header class="toolbar">
            <select aria-label="Network" value={network} onChange={(event) => setNetwork(event.currentTarget.value)}>
              <option value="">All networks</option>
              {rack?.networks.map((each) => (
                <option key={each.name}>{each.name}</option>
              ))}
            </select>
            <input
              type="search"
              placeholder="Filter, e.g. 6041"
              aria-label="Filter"
              value={filter}
              onInput={(event) => setFilter(event.currentTarget.value)}
            />
            <button type="button" aria-pressed={paused} onClick={() => setPaused(!paused)}>
              Pause
            </button>
            <button type="button" onClick={clear} disabled={frames.length === 0}>
              Clear
            </button>
            <span class="spacer" />
            <span class="soft">
              {shown.length} of {frames.length}
              {dropped > 0 ? `, ${dropped} lost on the way to this page` : ""}
            </span>
          </header>
          {problem === "" ? null : <p class="notice bad">{problem}</p>}
          <div class="scroller tall" tabIndex={0} role="region" aria-label="List of frames">
            {shown.length > 0 ? (
              <table>
                <thead>
                  <tr>
                    <th class="number">No.</th>
                    <th class="number time">Time</th>
                    <th class="device">Network</th>
                    <th class="arrow">
                      <span class="hidden-text">Direction</span>
                    </th>
                    <th>Frame</th>
                  </tr>
                </thead>
                <tbody>
                  {shown.map((frame) => (
                    <tr key={`${frame.network} ${frame.number}`} class={chosen === frame ? "chosen" : ""}>
                      <td class="number">{frame.number}</td>
                      <td class="number time">{timeText(frame.time_ns, 6)}</td>
                      <td class="device">{frame.network}</td>
                      <td class="arrow" title={frame.direction}>
                        <span aria-hidden="true">{kArrows[frame.direction] ?? "•"}</span>
                        <span class="hidden-text">{frame.direction}</span>
                      </td>
                      <td>
                        <button type="button" class="plain mono" onClick={() => setChosen(frame)}>
                          {frame.summary}
                        </button>
                      </td>
                    </tr>
                  ))}
                </tbody>
              </table>
            ) : (
              <p class="empty">
                {frames.length === 0
                  ? paused
                    ? "Paused."
                    : "No frames so far. They come when a master talks."
                  : "No frame fits the filter."}
              </p>
            )}
          </div>
        </section>
        <section class="panel">
          <header>
            <h2>{chosen ? `Frame ${chosen.number}` : "Frame"}</h2>
          </header>
          {chosen ? (
            <div class="scroller tall" tabIndex={0} role="region" aria-label="Content of the frame">
              <table>
                <tbody>
                  {chosen.fields.map(([name, value], i) => (
                    <tr key={i}>
                      <td class="soft">{name}</td>
                      <td class="mono">{value}</td>
                    </tr>
                  ))}
                </tbody>
              </table>
              <pre class="dump">{hexDump(chosen.raw)}</pre>
            </div>
          ) : (
            <p class="empty">Choose a frame to see its fields and bytes.</p>
          )}
        </section>
      </div>
    </>
  );
}
