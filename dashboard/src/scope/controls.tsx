import { t } from "../language";
import { numberText, timeText } from "./core/numbers";
import type { Oscilloscope } from "./oscilloscope";

const kPeriods = [50e3, 100e3, 250e3, 500e3, 1e6, 2e6, 5e6, 10e6, 50e6, 100e6];
const kSpans = [1e6, 2e6, 5e6, 10e6, 20e6, 50e6, 100e6, 200e6, 500e6, 1e9, 2e9, 5e9, 10e9, 20e9, 50e9, 100e9, 200e9, 500e9];
const kMemories = [16, 64, 128, 256, 512];

function withPresent(choices: readonly number[], present: number): number[] {
  return [...new Set([...choices, present])].sort((a, b) => a - b);
}

const kStates = {
  waiting: "waiting for trigger",
  triggered: "triggered",
  rolling: "running",
  done: "done",
} as const;

/// The same as a person reads them; what is in English names their colours.
const kStateTexts: Readonly<Record<string, string>> = {
  "no connection": t("no connection"),
  stopped: t("stopped"),
  "no channels": t("no channels"),
  "waiting for trigger": t("waiting for trigger"),
  triggered: t("triggered"),
  running: t("running"),
  done: t("done"),
};

/// Run and stop, time base, memory, and how acquisition goes.
export function Controls({ scope, attempt }: { scope: Oscilloscope; attempt: (action: () => void) => void }) {
  const { setup, record, statistics, acquisition } = scope;
  const state = !scope.isConnected
    ? "no connection"
    : !scope.running
      ? "stopped"
      : setup.channels.length === 0
        ? "no channels"
        : kStates[acquisition.state];
  const lost = statistics.droppedByServer + statistics.droppedByPage;
  return (
    <div class="toolbar scope-controls" role="toolbar" aria-label={t("Acquisition")}>
      <button
        type="button"
        class={scope.running ? "" : "primary"}
        aria-pressed={scope.running}
        onClick={() => (scope.running ? scope.stop() : scope.run())}
        title={t("Space")}
      >
        {scope.running ? t("Stop") : t("Run")}
      </button>
      <button type="button" onClick={() => attempt(() => scope.single())} title={t("Record one trigger, then stop (S)")}>
        {t("Single")}
      </button>
      <button type="button" disabled={!scope.running} onClick={() => scope.force()} title={t("As if the trigger had come now (T)")}>
        {t("Force")}
      </button>
      <label>
        <span class="hidden-text">{t("Trigger mode")}</span>
        <select
          value={setup.trigger.mode}
          onChange={(event) => {
            const mode = event.currentTarget.value as "auto" | "normal" | "single";
            attempt(() => scope.change({ trigger: { ...setup.trigger, mode } }));
          }}
        >
          <option value="auto">{t("Auto")}</option>
          <option value="normal">{t("Normal")}</option>
          <option value="single">{t("Single")}</option>
        </select>
      </label>
      <span class={`scope-state ${state.replaceAll(" ", "-")}`} role="status">
        {kStateTexts[state]}
      </span>
      <label>
        {t("Sampling")}{" "}
        <select
          aria-label={t("Sampling")}
          value={setup.period}
          onChange={(event) => attempt(() => scope.change({ period: Number(event.currentTarget.value) }))}
        >
          {withPresent(kPeriods, setup.period).map((period) => (
            <option key={period} value={period}>
              {timeText(period * 1e-9)}
            </option>
          ))}
        </select>
      </label>
      <label>
        {t("Shown")}{" "}
        <select
          aria-label={t("Shown")}
          value={setup.span}
          onChange={(event) => attempt(() => scope.change({ span: Number(event.currentTarget.value) }))}
        >
          {withPresent(kSpans, setup.span).map((span) => (
            <option key={span} value={span}>
              {timeText(span * 1e-9)}
            </option>
          ))}
        </select>
      </label>
      <label
        title={t("{capacity} rows, {number} MiB", {
          capacity: numberText(record.ring.capacity),
          number: numberText(record.ring.bytes / 2 ** 20, 3),
        })}
      >
        {t("Memory")}{" "}
        <select
          aria-label={t("Memory")}
          value={setup.memory}
          onChange={(event) => attempt(() => scope.change({ memory: Number(event.currentTarget.value) }))}
        >
          {withPresent(
            kMemories.map((each) => each * 2 ** 20),
            setup.memory,
          ).map((bytes) => (
            <option key={bytes} value={bytes}>
              {bytes / 2 ** 20} MiB{bytes === setup.memory ? ` = ${timeText(record.depth * 1e-9, 3)}` : ""}
            </option>
          ))}
        </select>
      </label>
      <button
        type="button"
        aria-pressed={setup.layout === "lanes"}
        onClick={() => attempt(() => scope.change({ layout: setup.layout === "lanes" ? "overlay" : "lanes" }))}
      >
        {t("One lane per unit")}
      </button>
      <button
        type="button"
        aria-pressed={setup.spectrum.shown}
        onClick={() => attempt(() => scope.change({ spectrum: { ...setup.spectrum, shown: !setup.spectrum.shown } }))}
      >
        FFT
      </button>
      <span class="spacer" />
      <output
        class={`mono soft scope-statistics ${lost + record.missing > 0 ? "lost" : ""}`}
        title={t("Rows that came, that are missing between them, that the server and the page dropped; frames per second of this page")}
        data-received={record.received}
        data-expected={record.expected}
        data-dropped={lost}
        data-fps={statistics.fps}
        data-slowest={statistics.slowest.toFixed(1)}
      >
        {lost > 0
          ? t("{received} rows, {missing} lost ({server} server, {page} page), {fps} fps", {
              received: record.received,
              missing: record.missing,
              server: statistics.droppedByServer,
              page: statistics.droppedByPage,
              fps: statistics.fps,
            })
          : t("{received} rows, {missing} lost, {fps} fps", { received: record.received, missing: record.missing, fps: statistics.fps })}
      </output>
    </div>
  );
}
