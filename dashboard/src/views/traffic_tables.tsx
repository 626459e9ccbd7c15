import { useState } from "preact/hooks";

import type { Frame } from "../api";
import { grouped, kNone, timeText } from "../format";
import { hexDump } from "../hex_dump";
import { t } from "../language";
import { type Repeating, valuesOf } from "../traffic_log";

const kArrows: Readonly<Record<string, string>> = { request: "→", answer: "←", bus: "•" };

function Direction({ frame }: { frame: Frame }) {
  return (
    <td class="arrow" title={frame.direction}>
      <span aria-hidden="true">{kArrows[frame.direction] ?? "•"}</span>
      <span class="hidden-text">{frame.direction}</span>
    </td>
  );
}

function valuesText(frame: Frame): string {
  return valuesOf(frame)
    .map(([name, value]) => `${name} = ${value}`)
    .join(", ");
}

function rateText({ rate, last }: Repeating, newest: number): string {
  const kPast = 2e9;
  return Number.isNaN(rate) || newest - last.time_ns > kPast ? kNone : `${grouped(rate < 10 ? rate.toFixed(1) : rate.toFixed(0))}/s`;
}

interface RepeatingTableProperties {
  readonly rows: readonly Repeating[];
  /// Time of the newest frame of all.
  readonly newest: number;
  readonly chosen: string;
  readonly onChoose: (key: string) => void;
}

/// One row for each kind of frame that comes again and again.
export function RepeatingTable({ rows, newest, chosen, onChoose }: RepeatingTableProperties) {
  const [open, setOpen] = useState<ReadonlySet<string>>(new Set());
  const toggle = (key: string) => setOpen((old) => new Set(old.has(key) ? [...old].filter((each) => each !== key) : [...old, key]));
  return (
    <table class="repeating">
      <thead>
        <tr>
          <th class="arrow">
            <span class="hidden-text">{t("Last frames")}</span>
          </th>
          <th class="number">{t("Count")}</th>
          <th class="number">{t("Rate")}</th>
          <th class="device">{t("Network")}</th>
          <th class="arrow">
            <span class="hidden-text">{t("Direction")}</span>
          </th>
          <th>{t("Frame, and what was in the last one")}</th>
        </tr>
      </thead>
      <tbody>
        {rows.map((row) => (
          <RepeatingRow
            key={row.key}
            row={row}
            newest={newest}
            open={open.has(row.key)}
            chosen={chosen === row.key}
            onToggle={() => toggle(row.key)}
            onChoose={() => onChoose(row.key)}
          />
        ))}
      </tbody>
    </table>
  );
}

interface RepeatingRowProperties {
  readonly row: Repeating;
  readonly newest: number;
  readonly open: boolean;
  readonly chosen: boolean;
  readonly onToggle: () => void;
  readonly onChoose: () => void;
}

function RepeatingRow({ row, newest, open, chosen, onToggle, onChoose }: RepeatingRowProperties) {
  const { last, count, recent } = row;
  return (
    <>
      <tr class={chosen ? "chosen" : ""}>
        <td class="arrow">
          <button
            type="button"
            class="plain"
            aria-expanded={open}
            aria-label={t("The last frames of {summary}", { summary: last.summary })}
            onClick={onToggle}
          >
            {open ? "▾" : "▸"}
          </button>
        </td>
        <td class="number" data-count={count}>
          {grouped(String(count))}
        </td>
        <td class="number">{rateText(row, newest)}</td>
        <td class="device">{last.network}</td>
        <Direction frame={last} />
        <td>
          <button type="button" class="plain mono" onClick={onChoose}>
            {last.summary}
          </button>
          <div class="soft values">{valuesText(last)}</div>
        </td>
      </tr>
      {open
        ? recent.map((frame) => (
            <tr key={frame.number} class="recent">
              <td />
              <td class="number soft">{frame.number}</td>
              <td class="number soft" colSpan={3}>
                {timeText(frame.time_ns, 6)}
              </td>
              <td class="values">{valuesText(frame) || <span class="mono">{frame.raw}</span>}</td>
            </tr>
          ))
        : null}
    </>
  );
}

interface FrameTableProperties {
  readonly frames: readonly Frame[];
  readonly chosen: Frame | null;
  readonly onChoose: (frame: Frame) => void;
}

/// Each frame for itself, the newest first.
export function FrameTable({ frames, chosen, onChoose }: FrameTableProperties) {
  return (
    <table>
      <thead>
        <tr>
          <th class="number">{t("No.")}</th>
          <th class="number time">{t("Time")}</th>
          <th class="device">{t("Network")}</th>
          <th class="arrow">
            <span class="hidden-text">{t("Direction")}</span>
          </th>
          <th>{t("Frame")}</th>
        </tr>
      </thead>
      <tbody>
        {frames.map((frame) => (
          <tr key={`${frame.network} ${frame.number}`} class={chosen === frame ? "chosen" : ""}>
            <td class="number">{frame.number}</td>
            <td class="number time">{timeText(frame.time_ns, 6)}</td>
            <td class="device">{frame.network}</td>
            <Direction frame={frame} />
            <td>
              <button type="button" class="plain mono" onClick={() => onChoose(frame)}>
                {frame.summary}
              </button>
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/// The fields and bytes of a frame.
export function FrameContent({ frame }: { frame: Frame }) {
  return (
    <div class="scroller tall" tabIndex={0} role="region" aria-label={t("Content of the frame")}>
      <table>
        <tbody>
          {frame.fields.map(([name, value], i) => (
            <tr key={i}>
              <td class="soft">{name}</td>
              <td class="mono">{value}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <pre class="dump">{hexDump(frame.raw)}</pre>
    </div>
  );
}
