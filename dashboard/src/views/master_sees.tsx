// The objects that a master looks at, bit by bit and in words, with their age.
import { useEffect, useRef, useState } from "preact/hooks";

import type { Declaration, Device, Entry, ManualControl, Objects } from "../api";
import { segment } from "../api";
import { axisIndex } from "../axes";
import { addressText, hexText, quantity, quantityText } from "../format";
import { type Resource, useConversion, useResource, useStore } from "../hooks";
import { t } from "../language";
import { href } from "../router";
import { controlwordBits, errorCodeText, errorRegisterBits, modeText, powerState, statuswordBits, type Bit } from "../words";

const kObjectPeriod = 500;
const kManualPeriod = 1000;
/// From this age on, in milliseconds, values are told to be old: several looks have failed.
const kOld = 3000;

function Bits({ bits }: { bits: readonly Bit[] }) {
  return (
    <ul class="bits">
      {bits.map((bit) => (
        <li key={bit.number} class={bit.set ? "set" : ""}>
          <span class="bit">{bit.number}</span>
          {bit.name}
          <span class="hidden-text">{bit.set ? ": 1" : ": 0"}</span>
        </li>
      ))}
    </ul>
  );
}

/// Of the objects a master looks at, those the device has.
const kWatched: readonly { index: number; perAxis: boolean; label: string }[] = [
  { index: 0x6041, perAxis: true, label: t("Statusword") },
  { index: 0x6040, perAxis: true, label: t("Controlword") },
  { index: 0x6061, perAxis: true, label: t("Mode of operation") },
  { index: 0x603f, perAxis: true, label: t("Error code") },
  { index: 0x1001, perAxis: false, label: t("Error register") },
  { index: 0x6064, perAxis: true, label: t("Position") },
  { index: 0x606c, perAxis: true, label: t("Velocity") },
  { index: 0x6077, perAxis: true, label: t("Torque") },
];

/// Renders again each second, and tells the time.
function useNow(): number {
  const [now, setNow] = useState(() => performance.now());
  useEffect(() => {
    const timer = setInterval(() => setNow(performance.now()), 1000);
    return () => clearInterval(timer);
  }, []);
  return now;
}

function secondsText(milliseconds: number): string {
  return `${Math.round(milliseconds / 1000)} s`;
}

/// Why what is shown is not what a master works with at present; empty: it is.
function useStaleness(device: Device, age: number, now: number): string {
  const store = useStore();
  const offered = store.offers("/api/v1/devices/{device}/manual");
  const manual = useResource<ManualControl>(offered ? `/api/v1/devices/${segment(device.name)}/manual` : null, kManualPeriod);
  if (age >= kOld) {
    return t("These values are {age} old: the rack does not answer in time.", { age: secondsText(age) });
  }
  const activity = store.masters.get(device.network);
  const silence = manual.data?.phase === "active" ? null : (activity?.silence(now) ?? null);
  if (silence === null || !activity) {
    return "";
  }
  return activity.hasSpoken
    ? t("The master of {network} has been silent for {silence}. This is what it would read now.", {
        network: device.network,
        silence: secondsText(silence),
      })
    : t("No master has spoken on {network} since this page was opened. This is what one would read now.", { network: device.network });
}

/// `objects`: those that the device has.
export function MasterSees({ device, axis, objects: declared }: { device: Device; axis: number; objects: Resource<Objects> }) {
  const path = `/api/v1/devices/${segment(device.name)}/objects`;
  const came = useRef(new Map<string, Resource<Entry>["at"]>());
  const now = useNow();
  const rows = kWatched.flatMap(({ index, perAxis, label }) => {
    const text = axisIndex(index, perAxis ? axis : 0);
    const entry = declared.data?.entries.find((each) => same(each, text));
    return entry ? [{ index, text, entry, label }] : [];
  });
  const times = rows.map((row) => came.current.get(row.text)?.current ?? now);
  const age = Math.max(0, now - Math.min(now, ...times));
  const stale = useStaleness(device, age, now);
  return (
    <section class="panel">
      <header>
        <h2>{t("What the master sees")}</h2>
        <span class="spacer" />
        <span class="soft">{age < kOld / 2 ? t("read just now") : t("read {age} ago", { age: secondsText(age) })}</span>
      </header>
      {stale === "" ? null : <p class="notice">{stale}</p>}
      {declared.data === null ? <p class="empty">{declared.error?.message ?? "…"}</p> : null}
      <table class={stale === "" ? "sees" : "sees stale"}>
        <tbody>
          {rows.map((row) => (
            <SeenRow
              key={row.text}
              path={path}
              row={row}
              device={device.name}
              modePath={`${path}/${axisIndex(0x6061, axis)}/00`}
              came={(at) => {
                came.current.set(row.text, at);
              }}
            />
          ))}
        </tbody>
      </table>
    </section>
  );
}

function same(entry: Declaration, index: string): boolean {
  return entry.index.toUpperCase() === index && Number.parseInt(entry.subindex, 16) === 0;
}

function SeenRow({
  path,
  row,
  device,
  modePath,
  came,
}: {
  path: string;
  row: { index: number; text: string; entry: Declaration; label: string };
  device: string;
  modePath: string;
  came: (at: Resource<Entry>["at"]) => void;
}) {
  const read = useResource<Entry>(`${path}/${row.text}/00`, kObjectPeriod);
  useEffect(() => came(read.at), [read.at]);
  const mode = useResource<Entry>(row.index === 0x6041 || row.index === 0x6040 ? modePath : null, kObjectPeriod);
  const value = read.data?.value;
  const number = typeof value === "number" ? value : null;
  return (
    <tr>
      <td>
        <a class="mono" href={href("device", [device, "objects"], { search: row.text })}>
          {addressText(row.text)}
        </a>
        <div class="soft">{row.label}</div>
      </td>
      <td>
        {number === null ? (
          <span class="soft">{read.error?.message ?? "…"}</span>
        ) : (
          <Seen device={device} index={row.index} value={number} unit={row.entry.unit} mode={Number(mode.data?.value ?? 0)} />
        )}
      </td>
    </tr>
  );
}

function Seen({ device, index, value, unit, mode }: { device: string; index: number; value: number; unit: string; mode: number }) {
  const shown = useConversion()(`${device}.`, unit);
  switch (index) {
    case 0x6041:
      return (
        <>
          <span class="mono">{hexText(value, 4)}</span> <strong>{powerState(value)}</strong>
          <Bits bits={statuswordBits(value, mode)} />
        </>
      );
    case 0x6040:
      return (
        <>
          <span class="mono">{hexText(value, 4)}</span>
          <Bits bits={controlwordBits(value, mode)} />
        </>
      );
    case 0x6061:
      return (
        <>
          {value} <span class="soft">{modeText(value)}</span>
        </>
      );
    case 0x603f:
      return (
        <span class={value === 0 ? "" : "wrong"}>
          <span class="mono">{hexText(value, 4)}</span> {errorCodeText(value)}
        </span>
      );
    case 0x1001: {
      const set = errorRegisterBits(value).filter((bit) => bit.set);
      return (
        <span class={value === 0 ? "" : "wrong"}>
          <span class="mono">{hexText(value, 2)}</span> {set.length === 0 ? t("no error") : set.map((bit) => bit.name).join(", ")}
        </span>
      );
    }
    default:
      return (
        <>
          {quantity(value, "").value}{" "}
          <span class="soft">
            {unit}
            {shown.unit === unit ? "" : ` = ${quantityText(value * shown.factor, shown.unit)}`}
          </span>
        </>
      );
  }
}
