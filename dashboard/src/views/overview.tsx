import type { ComponentChildren } from "preact";
import { useMemo, useRef } from "preact/hooks";

import type { Declaration, Device, Object as DeviceObject, Event, Objects, Panel, PanelAxis, StateMachine, StateMachines } from "../api";
import { segment } from "../api";
import { axesOf, axisIndex, axisNumber, type AxisSignals } from "../axes";
import { Gauge, rangeFor } from "../components/gauge";
import { InputsPanel } from "../components/inputs_panel";
import { MotionPanel } from "../components/motion_panel";
import { StateMachinePicture } from "../components/state_machine";
import { TryFault } from "../components/try_fault";
import { timeText } from "../format";
import { useConversion, useLive, useResource, useShownIn, useSignalList, useStore } from "../hooks";
import { t } from "../language";
import { limitObjects, limitsOf, type Limit } from "../limits";
import { sameState } from "../machine_layout";
import { motionUnit } from "../motion_units";
import { href, useChoice } from "../router";
import { EventRows, EventSentence } from "./events";
import { ManualPanel } from "./manual";
import { MasterSees } from "./master_sees";
import { ProgramView } from "./program";

const kEventsShown = 8;
const kLimitPeriod = 3000;

export function Overview({ device, panel }: { device: Device; panel: Panel | null }) {
  const store = useStore();
  const signals = useSignalList(`${segment(device.name)}.*`);
  const objects = useResource<Objects>(device.objects > 0 && device.powered ? objectsPath(device) : null);
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
            <div class="segmented" role="group" aria-label={t("Axis")}>
              {axes.map((each) => (
                <button key={each.name} type="button" aria-pressed={each === axis} onClick={() => setChosen(each.name)}>
                  {each.name}
                </button>
              ))}
            </div>
          ) : null}
          {axis ? (
            <AxisValues key={axis.name} device={device} axis={axis} panel={axisPanel} declared={objects.data?.entries ?? []} />
          ) : null}
          {axis ? (
            <MotionPanel
              key={`motion ${axis.name}`}
              device={device.name}
              axis={axis.name}
              axes={axes.map((each) => each.name)}
              signals={signals.data}
            />
          ) : null}
          <InputsPanel device={device} signals={signals.data} first={axis?.name ?? ""} />
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
            >
              <TryFault
                name={t("the connection of {name}", { name: device.name })}
                places={["port", "bus"]}
                at={{ device: device.name }}
                network={store.networkKind(device.network)}
              />
            </MachinePanel>
          ) : null}
          {panel?.program && store.offers("/api/v1/devices/{device}/program") ? <ProgramView device={device} /> : null}
          {power || network ? null : <DeviceEvents name={device.name} />}
        </div>
        <div class="stack last">
          {device.objects > 0 && device.powered ? (
            <MasterSees device={device} axis={axisNumber(axis?.name ?? "")} objects={objects} />
          ) : null}
          {power || network ? <DeviceEvents name={device.name} /> : null}
        </div>
      </div>
    </>
  );
}

function objectsPath(device: Device): string {
  return `/api/v1/devices/${segment(device.name)}/objects`;
}

/// `declared`: the objects of the device, of which some are limits.
function AxisValues({
  device,
  axis,
  panel,
  declared,
}: {
  device: Device;
  axis: AxisSignals;
  panel: PanelAxis | null;
  declared: readonly Declaration[];
}) {
  const store = useStore();
  return (
    <section class="panel">
      <header>
        <h2>{axis.name}</h2>
        {panel?.state ? <span class="badge accent">{panel.state}</span> : null}
        {panel?.mode_name ? <span class="soft">{panel.mode_name}</span> : null}
        <span class="spacer" />
        {store.offers("/api/v1/rack/file") ? (
          <a href={href("rack-file", [], { device: device.name, axis: String(axisNumber(axis.name)) })}>{t("Motor and load")}</a>
        ) : null}
        {/\d$/.test(axis.name) ? (
          <TryFault
            name={`${device.name}, ${axis.name}`}
            places={["axis"]}
            at={{ device: device.name, axis: axisNumber(axis.name) }}
            network={store.networkKind(device.network)}
          />
        ) : null}
      </header>
      <div class="body gauges">
        {axis.rows.map(({ label, signal }) => (
          <LiveGauge
            key={`${signal} ${motionUnit.value}`}
            name={label}
            signal={signal}
            device={device}
            axis={axisNumber(axis.name)}
            declared={declared}
          />
        ))}
      </div>
    </section>
  );
}

/// The limits of a signal of an axis that objects of its drive are, two of them at most.
function useLimits(device: Device, axis: number, signal: string, declared: readonly Declaration[]): readonly Limit[] {
  const at = (index: number) => axisIndex(index, axis);
  const [first, second] = limitObjects(signal, declared, at);
  const pathOf = (index: string | undefined) => (index === undefined ? null : `${objectsPath(device)}/${index}`);
  const one = useResource<DeviceObject>(pathOf(first), kLimitPeriod).data;
  const other = useResource<DeviceObject>(pathOf(second), kLimitPeriod).data;
  return useMemo(
    () =>
      limitsOf(
        signal,
        [one, other].filter((each) => each !== null),
        at,
      ),
    [signal, one, other, axis],
  );
}

/// A bar whose range grows with what it has shown.
function LiveGauge({
  name,
  signal,
  device,
  axis,
  declared,
}: {
  name: string;
  signal: string;
  device: Device;
  axis: number;
  declared: readonly Declaration[];
}) {
  const own = useLive(signal).value;
  const live = useShownIn()(signal, own);
  const { factor } = useConversion()(signal, own?.unit ?? "");
  const ownLimits = useLimits(device, axis, signal, declared);
  const limits = useMemo(() => ownLimits.map((limit) => ({ ...limit, value: limit.value * factor })), [ownLimits, factor]);
  const seen = useRef({ low: 0, high: 0 }).current;
  if (typeof live?.value === "number") {
    seen.low = Math.min(seen.low, live.value);
    seen.high = Math.max(seen.high, live.value);
  }
  const range = live?.unit === "degC" ? { minimum: 0, maximum: Math.max(150, seen.high) } : rangeFor(seen, live?.unit, limits);
  return <Gauge name={name} live={live} range={range} limits={limits} />;
}

function MachinePanel({
  machine,
  state,
  title,
  refusal,
  children,
}: {
  machine: StateMachine;
  state: string;
  title: string;
  refusal: Event | null;
  children?: ComponentChildren;
}) {
  const known = machine.states.some((each) => sameState(each, state));
  return (
    <section class="panel">
      <header>
        <h2>{title}</h2>
        {known ? null : <span class="badge accent">{state}</span>}
        <span class="spacer" />
        {children}
      </header>
      <div class="body machine-body">
        <StateMachinePicture machine={machine} state={state} />
      </div>
      {refusal ? (
        <div class="notice warning">
          <strong>{t("Last refusal")}</strong> <span class="soft">{t("at {time_ns}", { time_ns: timeText(refusal.time_ns) })}</span>
          <br />
          <EventSentence event={refusal} place="refusal" />
        </div>
      ) : null}
    </section>
  );
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
        <h2>{t("Newest events")}</h2>
        <span class="spacer" />
        <a href={href("events", [], { device: name })}>{t("All events of {name}", { name })}</a>
      </header>
      {own.length > 0 ? (
        <EventRows events={own} short />
      ) : (
        <p class="empty">{t("Nothing has happened so far. Take control above, connect a master, or try a fault.")}</p>
      )}
    </section>
  );
}
