import { useState } from "preact/hooks";

import type { Frame } from "../api";
import { grouped } from "../format";
import { useStore } from "../hooks";
import { t } from "../language";
import { useChoice } from "../router";
import { FrameContent, FrameTable, RepeatingTable } from "./traffic_tables";
import { useTraffic } from "./use_traffic";

const kMostShown = 200; // what is drawn anew a few times a second

const text = (count: number) => grouped(String(count));

export function TrafficView() {
  const { rack } = useStore();
  const [network, setNetwork] = useChoice("network");
  const [filter, setFilter] = useChoice("search");
  const [paused, setPaused] = useState(false);
  const [everything, setEverything] = useState(false);
  /// A frame, or the key of a kind that repeats, whose newest is shown.
  const [chosen, setChosen] = useState<Frame | string | null>(null);
  const { log, lost, problem, clear } = useTraffic({ networks: network === "" ? [] : [network], filter }, paused);
  const words = filter.toLowerCase();
  const fits = (frame: Frame) =>
    (network === "" || frame.network === network) &&
    (words === "" || `${frame.summary} ${frame.fields.flat().join(" ")}`.toLowerCase().includes(words));
  const repeating = everything ? [] : log.repeating.filter(({ last }) => fits(last));
  const frames = log.newestOf(everything ? "all" : "single", kMostShown, fits);
  const content = typeof chosen === "string" ? (repeating.find(({ key }) => key === chosen)?.last ?? null) : chosen;
  return (
    <>
      <div class="view-head">
        <h1>{t("Traffic")}</h1>
        <span class="soft">{t("What masters and devices send, decoded; frames of which only data change are counted in one row")}</span>
      </div>
      <div class="traffic">
        <section class="panel">
          <header class="toolbar">
            <select aria-label={t("Network")} value={network} onChange={(event) => setNetwork(event.currentTarget.value)}>
              <option value="">{t("All networks")}</option>
              {rack?.networks.map((each) => (
                <option key={each.name}>{each.name}</option>
              ))}
            </select>
            <input
              type="search"
              placeholder={t("Filter, e.g. 6041")}
              aria-label={t("Filter")}
              value={filter}
              onInput={(event) => setFilter(event.currentTarget.value)}
            />
            <button type="button" aria-pressed={paused} onClick={() => setPaused(!paused)}>
              {t("Pause")}
            </button>
            <button type="button" onClick={clear} disabled={log.received === 0}>
              {t("Clear")}
            </button>
            <label class="check">
              <input type="checkbox" checked={everything} onChange={(event) => setEverything(event.currentTarget.checked)} />
              {t("Every frame")}
            </label>
            <span class="spacer" />
            <span class="soft traffic-counts" data-received={log.received} data-single={log.single} data-lost={lost}>
              {t("{received} frames, {repeated} of them in {rows} rows that repeat", {
                received: text(log.received),
                repeated: text(log.received - log.single),
                rows: log.repeating.length,
              })}
              {lost > 0 ? `; ${t("{lost} lost on the way to this page", { lost: text(lost) })}` : ""}
            </span>
          </header>
          {problem === "" ? null : <p class="notice bad">{problem}</p>}
          <div class="scroller tall" tabIndex={0} role="region" aria-label={t("List of frames")}>
            {repeating.length > 0 ? (
              <>
                <h2 class="part">{t("Again and again")}</h2>
                <RepeatingTable
                  rows={repeating}
                  newest={log.newest}
                  chosen={typeof chosen === "string" ? chosen : ""}
                  onChoose={setChosen}
                />
                <h2 class="part">{t("Once: messages, changes of state")}</h2>
              </>
            ) : null}
            {frames.length > 0 ? (
              <FrameTable frames={frames} chosen={typeof chosen === "string" ? null : chosen} onChoose={setChosen} />
            ) : repeating.length > 0 ? (
              <p class="empty">{t("None but what repeats.")}</p>
            ) : (
              <Nothing received={log.received} paused={paused} />
            )}
          </div>
        </section>
        <section class="panel">
          <header>
            <h2>{content === null ? t("Frame") : t("Frame {number}", { number: content.number })}</h2>
          </header>
          {content === null ? <p class="empty">{t("Choose a frame to see its fields and bytes.")}</p> : <FrameContent frame={content} />}
        </section>
      </div>
    </>
  );
}

function Nothing({ received, paused }: { received: number; paused: boolean }) {
  return (
    <p class="empty">
      {received > 0 ? t("No frame fits the filter.") : paused ? t("Paused.") : t("No frames so far. They come when a master talks.")}
    </p>
  );
}
