import { useCallback, useEffect, useMemo, useState } from "preact/hooks";

import { segment, type Device, type ManualAxis, type ManualCommand, type ManualCommandName, type ManualControl } from "../api";
import { HeldButton } from "../components/held_button";
import { hexText } from "../format";
import { refusalText, useAction, useResource, useStore, useWorld } from "../hooks";
import { Jog } from "../jog";
import { t, tx } from "../language";
import { motionUnit, numberOf, Scale, unitsOf, type MotionUnit } from "../motion_units";
import { chooseUnit } from "../router";
import "../styles/manual.css";
import { controlwordBits, errorCodeText, modeText } from "../words";
import { Homing, HomingBadge, kHoming, useHomingMethods } from "./homing";

const kActivePeriod = 200;
const kIdlePeriod = 3000; ///< somebody else may take control, from another page or a terminal

type Send = (axis: number, command: ManualCommand) => Promise<boolean>;

/// Moves the axes of a device by hand, through the small master inside Stator.
export function ManualPanel({ device }: { device: Device }) {
  const { api } = useWorld();
  const store = useStore();
  const action = useAction();
  const offered = store.offers("/api/v1/devices/{device}/manual");
  const path = `/api/v1/devices/${segment(device.name)}/manual`;
  const [period, setPeriod] = useState(kIdlePeriod);
  const control = useResource<ManualControl>(offered ? path : null, period);
  const status = control.data;
  const phase = status?.phase ?? "off";
  const under = phase === "starting" || phase === "active";
  useEffect(() => setPeriod(under ? kActivePeriod : kIdlePeriod), [under]);
  const change = (method: "PUT" | "DELETE") => void action.run(() => api.send(method, path)).then(control.reload);
  if (!status) {
    return null;
  }
  if (phase === "active") {
    return (
      <>
        <ActiveControl device={device.name} path={path} axes={status.axes} giveBack={() => change("DELETE")} />
        {action.error === "" ? null : (
          <p class="notice bad" role="alert">
            {action.error}
          </p>
        )}
      </>
    );
  }
  return (
    <section class="panel manual-start">
      <header>
        <h2>{t("Move by hand")}</h2>
        {phase === "ended" ? <span class="badge warning">{t("ended")}</span> : null}
      </header>
      <div class="body">
        {status.available && phase !== "ended" ? (
          <p class="soft">
            {t("A small master inside Stator takes {device} into operation, so that its axes can be moved from here.", {
              device: device.name,
            })}{" "}
            {device.network === ""
              ? t("It steps aside when another master speaks.")
              : t("It steps aside when another master speaks on {network}.", { network: device.network })}
          </p>
        ) : (
          <p role="status">
            {status.available ? status.text : t("{name} cannot be moved by hand: {text}.", { name: device.name, text: status.text })}
          </p>
        )}
        {status.available ? (
          <button type="button" class="primary" disabled={action.busy || phase === "starting"} onClick={() => change("PUT")}>
            {phase === "starting" ? t("Taking control …") : phase === "ended" ? t("Take control again") : t("Take control")}
          </button>
        ) : null}
      </div>
      {action.error === "" ? null : (
        <p class="notice bad" role="alert">
          {action.error}
        </p>
      )}
    </section>
  );
}

/// Of CiA 402: it homes as its object 6098h says, while modules with TMCL have their own way.
function isDrive({ statusword }: ManualAxis): boolean {
  return statusword !== null;
}

function ActiveControl({
  device,
  path,
  axes,
  giveBack,
}: {
  device: string;
  path: string;
  axes: readonly ManualAxis[];
  giveBack: () => void;
}) {
  const { api } = useWorld();
  const units = unitsOf(axes);
  const methods = useHomingMethods(device, axes.some(isDrive));
  const unit = units.find((each) => each.unit === motionUnit.value)?.unit ?? "device";
  const [problems, setProblems] = useState<Readonly<Record<number, string>>>({});
  const send: Send = useCallback(
    async (axis, command) => {
      let problem = "";
      try {
        await api.send("POST", `${path}/${axis}`, command);
      } catch (wrong) {
        problem = refusalText(wrong);
      }
      setProblems((old) => ((old[axis] ?? "") === problem ? old : { ...old, [axis]: problem }));
      return problem === "";
    },
    [api, path],
  );
  const count = axes.length;
  const jogs = useMemo(() => Array.from({ length: count }, (_, axis) => new Jog((command) => send(axis, command))), [count, send]);
  const stop = useCallback(
    (axis: number) => {
      jogs[axis]?.release();
      void send(axis, { command: "stop" });
    },
    [jogs, send],
  );
  // An axis that is not enabled stands or brakes already, and a drive refuses it the controlword of a stop.
  const moving = axes.flatMap((axis, number) => (axis.enabled ? [number] : [])).join(" ");
  const stopAll = useCallback(() => moving.split(" ").forEach((axis) => axis === "" || stop(Number(axis))), [moving, stop]);
  useEffect(() => {
    const pressed = (event: KeyboardEvent) => {
      if (event.key === "Escape" && !event.repeat) {
        stopAll();
      }
    };
    document.addEventListener("keydown", pressed);
    return () => document.removeEventListener("keydown", pressed);
  }, [stopAll]);
  return (
    <>
      <div class="manual-bar">
        <h2>{t("Move by hand")}</h2>
        {units.length > 1 ? (
          <label class="unit-choice">
            <span class="soft">{t("in")}</span>
            <select
              aria-label={t("Unit of positions and speeds")}
              value={unit}
              onChange={(event) => chooseUnit(event.currentTarget.value as MotionUnit)}
            >
              {units.map((each) => (
                <option key={each.unit} value={each.unit}>
                  {each.name}
                </option>
              ))}
            </select>
          </label>
        ) : null}
        <span class="spacer" />
        <button type="button" onClick={giveBack} title={t("Its axes lose their current, and another master can have the device")}>
          {t("Give back")}
        </button>
        <button type="button" class="stop" onClick={stopAll} title={t("Brakes all axes of the device; so does Escape")}>
          {count > 1 ? t("Stop all") : t("Stop")} <kbd>Esc</kbd>
        </button>
      </div>
      <div class="manual-axes">
        {axes.map((axis, number) => (
          <AxisControl
            key={number}
            device={device}
            number={number}
            methods={methods}
            title={count > 1 ? t("axis {number}", { number }) : t("axis")}
            axis={axis}
            unit={unit}
            problem={problems[number] ?? ""}
            jog={jogs[number] as Jog}
            send={(command) => void send(number, command)}
            stop={() => stop(number)}
          />
        ))}
      </div>
    </>
  );
}

function AxisControl({
  device,
  number,
  methods,
  title,
  axis,
  unit,
  problem,
  jog,
  send,
  stop,
}: {
  device: string;
  number: number;
  /// Of homing.
  methods: readonly number[];
  title: string;
  axis: ManualAxis;
  unit: MotionUnit;
  problem: string;
  jog: Jog;
  send: (command: ManualCommand) => void;
  stop: () => void;
}) {
  const position = new Scale(unit, "position", axis.position_per_revolution);
  const velocity = new Scale(unit, "velocity", axis.velocity_per_revolution);
  const [speed, setSpeed] = useState<number | null>(axis.profile_velocity > 0 ? axis.profile_velocity : axis.velocity_per_revolution);
  const takes = (command: ManualCommandName) => axis.commands.includes(command);
  const moves = axis.enabled && speed !== null;
  const refusal = problem === "" ? axis.refusal : problem;
  const hasMethods = isDrive(axis);
  return (
    <section class="panel manual-axis" aria-label={t("Move {title} by hand", { title })}>
      <header>
        <h3>{title}</h3>
        <span class={axis.fault ? "badge bad" : axis.enabled ? "badge good" : "badge"}>{axis.state}</span>
        {axis.mode === kHoming && axis.statusword !== null ? (
          <HomingBadge statusword={axis.statusword} />
        ) : axis.enabled && axis.reached ? (
          <span class="soft">{t("target reached")}</span>
        ) : null}
        <span class="spacer" />
        {takes("enable") && !axis.enabled ? (
          <button type="button" class="primary" disabled={axis.fault} onClick={() => send({ command: "enable" })}>
            {t("Enable")}
          </button>
        ) : null}
        {takes("disable") && axis.enabled ? (
          <button type="button" onClick={() => send({ command: "disable" })}>
            {t("Disable")}
          </button>
        ) : null}
      </header>
      <div class="body">
        <dl class="readings">
          <div>
            <dt>{t("Position")}</dt>
            <dd>
              {position.text(axis.position)} <span class="soft">{position.name}</span>
            </dd>
          </div>
          <div>
            <dt>{t("Velocity")}</dt>
            <dd>
              {velocity.text(axis.velocity)} <span class="soft">{velocity.name}</span>
            </dd>
          </div>
        </dl>
        {axis.fault ? (
          <div class="notice bad fault">
            <span>
              {axis.error_code === null ? (
                t("The axis is in a fault and tells no error code")
              ) : (
                <>
                  {tx("Error code {what}: {error_code}", {
                    what: <span class="mono">{hexText(axis.error_code, 4)}</span>,
                    error_code: errorCodeText(axis.error_code),
                  })}
                </>
              )}
            </span>
            {takes("reset-fault") ? (
              <button type="button" onClick={() => send({ command: "reset-fault" })}>
                {t("Reset fault")}
              </button>
            ) : null}
          </div>
        ) : axis.enabled ? null : (
          <p class="soft">{t("Enable the axis to move it.")}</p>
        )}
        <div class="jog">
          <HeldButton
            label={t("Turn {title} left while held", { title })}
            disabled={!moves}
            onHold={() => jog.hold(-(speed ?? 0))}
            onRelease={() => jog.release()}
          >
            {t("◀ hold")}
          </HeldButton>
          <NumberField label={t("Speed")} name={velocity.name} scale={velocity} value={speed} change={setSpeed} least={1} />
          <HeldButton
            label={t("Turn {title} right while held", { title })}
            disabled={!moves}
            onHold={() => jog.hold(speed ?? 0)}
            onRelease={() => jog.release()}
          >
            {t("hold ▶")}
          </HeldButton>
        </div>
        <MoveForm
          scale={position}
          disabled={!moves}
          move={(value, relative) => send({ command: "move", value, relative, velocity: speed ?? 1 })}
        />
        <div class="actions">
          <button type="button" class="stop" aria-label={t("Stop {title}", { title })} disabled={!axis.enabled} onClick={stop}>
            {t("Stop")}
          </button>
          {takes("quick-stop") ? (
            <button type="button" disabled={!axis.enabled} onClick={() => send({ command: "quick-stop" })}>
              {t("Quick stop")}
            </button>
          ) : null}
          {takes("home") && !hasMethods ? (
            <button type="button" disabled={!axis.enabled} onClick={() => send({ command: "home" })}>
              {t("Home")}
            </button>
          ) : null}
        </div>
        {takes("home") && hasMethods ? (
          <Homing
            device={device}
            axis={number}
            title={title}
            methods={methods}
            enabled={axis.enabled}
            home={() => send({ command: "home" })}
          />
        ) : null}
        {takes("mode") && axis.mode !== null ? <ModeChoice mode={axis.mode} modes={axis.modes} send={send} /> : null}
        <p class={refusal === "" ? "refusal" : "refusal notice bad"} role="status">
          {refusal}
        </p>
      </div>
      {takes("controlword") && axis.controlword !== null ? (
        <Controlword written={axis.controlword} mode={axis.mode ?? 0} write={(value) => send({ command: "controlword", value })} />
      ) : null}
    </section>
  );
}

/// A quantity in the unit of `scale`; `value` and `change` have that of the device. Null: what stands there is none.
function NumberField({
  label,
  name,
  scale,
  value,
  change,
  least,
}: {
  label: string;
  name: string;
  scale: Scale;
  value: number | null;
  change: (value: number | null) => void;
  least?: number;
}) {
  const [text, setText] = useState<string | null>(null);
  return (
    <label class="field">
      <span>
        {label} <span class="soft">{name}</span>
      </span>
      <input
        inputMode="decimal"
        autocomplete="off"
        aria-invalid={value === null}
        value={text ?? (value === null ? "" : scale.field(value))}
        onInput={(event) => {
          setText(event.currentTarget.value);
          const typed = numberOf(event.currentTarget.value);
          const device = typed === null ? null : scale.toDevice(typed);
          change(device === null || (least !== undefined && device < least) ? null : device);
        }}
        onBlur={() => {
          if (value !== null) {
            setText(null);
          }
        }}
      />
    </label>
  );
}

function MoveForm({ scale, disabled, move }: { scale: Scale; disabled: boolean; move: (value: number, relative: boolean) => void }) {
  const [target, setTarget] = useState<number | null>(scale.toDevice(1));
  const go = (relative: boolean) => {
    if (target !== null) {
      move(target, relative);
    }
  };
  const cannot = disabled || target === null;
  return (
    <form
      class="move"
      onSubmit={(event) => {
        event.preventDefault();
        if (!cannot) {
          go(false);
        }
      }}
    >
      <NumberField label={t("Target or distance")} name={scale.name} scale={scale} value={target} change={setTarget} />
      <button type="submit" disabled={cannot}>
        {t("Move to")}
      </button>
      <button type="button" disabled={cannot} onClick={() => go(true)}>
        {t("Move by")}
      </button>
    </form>
  );
}

function ModeChoice({ mode, modes, send }: { mode: number; modes: readonly number[]; send: (command: ManualCommand) => void }) {
  const listed = modes.includes(mode) ? modes : [mode, ...modes];
  return (
    <label class="field mode">
      <span>{t("Mode of operation")}</span>
      <select value={mode} onChange={(event) => send({ command: "mode", value: Number(event.currentTarget.value) })}>
        {listed.map((each) => (
          <option key={each} value={each}>
            {each} {modeText(each)}
          </option>
        ))}
      </select>
    </label>
  );
}

/// The bits stand as they were written last until one is changed.
function Controlword({ written, mode, write }: { written: number; mode: number; write: (value: number) => void }) {
  const [own, setOwn] = useState<number | null>(null);
  const value = own ?? written;
  return (
    <details class="controlword">
      <summary>
        {t("Controlword")} <span class="mono">{hexText(written, 4)}</span>
      </summary>
      <div class="body">
        <div class="bit-toggles" role="group" aria-label={t("Bits of the controlword")}>
          {controlwordBits(value, mode).map((bit) => (
            <button key={bit.number} type="button" aria-pressed={bit.set} onClick={() => setOwn(value ^ (1 << bit.number))}>
              <span class="bit">{bit.number}</span> {bit.name}
            </button>
          ))}
        </div>
        <div class="toolbar">
          <button
            type="button"
            class="primary"
            onClick={() => {
              write(value);
              setOwn(null);
            }}
          >
            {t("Write")} <span class="mono">{hexText(value, 4)}</span>
          </button>
          {own === null ? null : (
            <button type="button" onClick={() => setOwn(null)}>
              {t("As written last")}
            </button>
          )}
        </div>
      </div>
    </details>
  );
}
