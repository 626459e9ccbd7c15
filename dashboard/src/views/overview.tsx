import { useMemo, useRef } from "preact/hooks";

import type { Declaration, Device, Entry, Event, Objects, Panel, PanelAxis, Signals, StateMachine, StateMachines } from "../api";
import { segment } from "../api";
import { axesOf, axisIndex, axisNumber, type AxisSignals } from "../axes";
import { Gauge, rangeFor } from "../components/gauge";
import { InputsPanel } from "../components/inputs_panel";
import { MotionPanel } from "../components/motion_panel";
import { StateMachinePicture } from "../components/state_machine";
import { addressText, hexText, quantity, timeText } from "../format";
import { useLive, useResource, useStore } from "../hooks";
import { sameState } from "../machine_layout";
import { href, useChoice } from "../router";
import { controlwordBits, errorCodeText, errorRegisterBits, modeText, powerState, statuswordBits, type Bit } from "../words";
import { EventRows } from "./events";
import { ManualPanel } from "./manual";
import { ProgramView } from "./program";

const kObjectPeriod = 500;
const kEventsShown = 8;

/// `asked`: what to search for among the inputs, of the page's address.
export function Overview({ device, panel, asked }: { device: Device; panel: Panel | null; asked: string }) {
  const store = useStore();
  const signals = useResource<Signals>(`/api/v1/signals?names=${segment(device.name)}.*`);
  const machines = useResource<StateMachines>(store.offers("/api/v1/state-machines") ? "/api/v1/state-machines" : null);
  const [chosen, setChosen] = useChoice("axis");
  const axes = useMemo(
    () => axesOf(device.name, signals.data?.signals ?? [], panel?.axes ?? []),
    [device.name, signals.data, panel?.axes.map((axis) => axis.name).join(" ")],
  );
  const axis = axes.find((each) => each.name === chosen) ?? axes[0];
  const axisPanel = panel?.axes.find((each) => each.name === axis?.name) ?? null;
  const machineOf = (name: string | null | undefined) => machines.data?.machines.find((each) => each.name === name);
  const network = machineOf(panel?.network?.machine);
  const power = machineOf(axisPanel?.machine);
  return (
    <>
      <ManualPanel device={device} />
      <div class="overview">
        <div class="stack">
          {axes.length > 1 ? (
            <div class="segmented" role="group" aria-label="Axis">
              {axes.map((each) => (
                <button key={each.name} type="button" aria-pressed={each === axis} onClick={() => setChosen(each.name)}>
                  {each.name}
                </button>
              ))}
            </div>
          ) : null}
          {axis ? <AxisValues key={axis.name} axis={axis} panel={axisPanel} /> : null}
          {axis ? (
            <MotionPanel
              key={`motion ${axis.name}`}
              device={device.name}
              axis={axis.name}
              axes={axes.map((each) => each.name)}
              signals={signals.data}
            />
          ) : null}
          <InputsPanel device={device} signals={signals.data} first={axis?.name ?? ""} asked={asked} />
        </div>
        <div class="stack">
          {power && axisPanel?.state ? (
            <MachinePanel
              machine={power}
              state={axisPanel.state}
              title={`${axisPanel.name}: ${power.title}`}
              refusal={axisPanel.last_refusal}
            />
          ) : null}
          {network && panel?.network ? (
            <MachinePanel
              machine={network}
              state={panel.network.state}
              title={network.title}
              refusal={panel.last_refusal?.number === axisPanel?.last_refusal?.number ? null : panel.last_refusal}
            />
          ) : null}
          {panel?.program && store.offers("/api/v1/devices/{device}/program") ? <ProgramView device={device} /> : null}
          {power || network ? null : <DeviceEvents name={device.name} />}
        </div>
        <div class="stack last">
          {device.objects > 0 && device.powered ? <MasterSees device={device} axis={axisNumber(axis?.name ?? "")} /> : null}
          {power || network ? <DeviceEvents name={device.name} /> : null}
        </div>
      </div>
    </>
  );
}

function AxisValues({ axis, panel }: { axis: AxisSignals; panel: PanelAxis | null }) {
  return (
    <section class="panel">
      <header>
        <h2>{axis.name}</h2>
        {panel?.state ? <span class="badge accent">{panel.state}</span> : null}
        {panel?.mode_name ? <span class="soft">{panel.mode_name}</span> : null}
      </header>
      <div class="body gauges">
        {axis.rows.map(({ label, signal }) => (
          <LiveGauge key={signal} name={label} signal={signal} />
        ))}
      </div>
    </section>
  );
}

/// A bar whose range grows with what it has shown.
function LiveGauge({ name, signal }: { name: string; signal: string }) {
  const live = useLive(signal).value;
  const seen = useRef({ low: 0, high: 0 }).current;
  if (typeof live?.value === "number") {
    seen.low = Math.min(seen.low, live.value);
    seen.high = Math.max(seen.high, live.value);
  }
  const range = live?.unit === "degC" ? { minimum: 0, maximum: Math.max(150, seen.high) } : rangeFor(seen);
  return <Gauge name={name} live={live} range={range} />;
}

function MachinePanel({ machine, state, title, refusal }: { machine: StateMachine; state: string; title: string; refusal: Event | null }) {
  const known = machine.states.some((each) => sameState(each, state));
  return (
    <section class="panel">
      <header>
        <h2>{title}</h2>
        {known ? null : <span class="badge accent">{state}</span>}
      </header>
      <div class="body machine-body">
        <StateMachinePicture machine={machine} state={state} />
      </div>
      {refusal ? (
        <p class="notice warning">
          <strong>Last refusal</strong> <span class="soft">at {timeText(refusal.time_ns)}</span>
          <br />
          {refusal.text}
        </p>
      ) : null}
    </section>
  );
}

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
  { index: 0x6041, perAxis: true, label: "Statusword" },
  { index: 0x6040, perAxis: true, label: "Controlword" },
  { index: 0x6061, perAxis: true, label: "Mode of operation" },
  { index: 0x603f, perAxis: true, label: "Error code" },
  { index: 0x1001, perAxis: false, label: "Error register" },
  { index: 0x6064, perAxis: true, label: "Position" },
  { index: 0x606c, perAxis: true, label: "Velocity" },
  { index: 0x6077, perAxis: true, label: "Torque" },
];

function MasterSees({ device, axis }: { device: Device; axis: number }) {
  const path = `/api/v1/devices/${segment(device.name)}/objects`;
  const declared = useResource<Objects>(path);
  const rows = kWatched.flatMap(({ index, perAxis, label }) => {
    const text = axisIndex(index, perAxis ? axis : 0);
    const entry = declared.data?.entries.find((each) => same(each, text));
    return entry ? [{ index, text, entry, label }] : [];
  });
  return (
    <section class="panel">
      <header>
        <h2>What the master sees</h2>
      </header>
      {declared.data === null ? <p class="empty">{declared.error?.message ?? "…"}</p> : null}
      <table class="sees">
        <tbody>
          {rows.map((row) => (
            <SeenRow key={row.text} path={path} row={row} device={device.name} modePath={`${path}/${axisIndex(0x6061, axis)}/00`} />
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
}: {
  path: string;
  row: { index: number; text: string; entry: Declaration; label: string };
  device: string;
  modePath: string;
}) {
  const read = useResource<Entry>(`${path}/${row.text}/00`, kObjectPeriod);
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
          <Seen index={row.index} value={number} unit={row.entry.unit} mode={Number(mode.data?.value ?? 0)} />
        )}
      </td>
    </tr>
  );
}

function Seen({ index, value, unit, mode }: { index: number; value: number; unit: string; mode: number }) {
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
          <span class="mono">{hexText(value, 2)}</span> {set.length === 0 ? "no error" : set.map((bit) => bit.name).join(", ")}
        </span>
      );
    }
    default:
      return (
        <>
          {quantity(value, "").value} <span class="soft">{unit}</span>
        </>
      );
  }
}

function DeviceEvents({ name }: { name: string }) {
  const { events } = useStore();
  const own = events
    .filter((event) => event.device === name)
    .slice(-kEventsShown)
    .reverse();
  return (
    <section class="panel">
      <header>
        <h2>Newest events</h2>
      </header>
      {own.length > 0 ? <EventRows events={own} short /> : <p class="empty">Nothing has happened so far.</p>}
    </section>
  );
}
