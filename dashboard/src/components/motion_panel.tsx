// How an axis moves: the motor as a picture, and the same in numbers.
import { computed, type ReadonlySignal } from "@preact/signals";
import { useEffect, useMemo, useState } from "preact/hooks";

import type { Signals } from "../api";
import { useMedia, useShownIn, useWorld } from "../hooks";
import { t } from "../language";
import { motorNumbers, motorSignals, type MotorNumber, type MotorSignals } from "../motion";
import "../styles/motion.css";
import { MachineView } from "./machine_view";
import { MotorPicture, type Frame } from "./motor_picture";

/// `axes`: all of the device; three of them make a gantry.
export function MotionPanel({
  device,
  axis,
  axes,
  signals,
}: {
  device: string;
  axis: string;
  axes: readonly string[];
  signals: Signals | null;
}) {
  const known = useMemo(() => new Set(signals?.signals.map((signal) => signal.name)), [signals]);
  const motor = useMemo(() => motorSignals(device, axis, known), [device, axis, known]);
  const machine = useMemo(() => machineOf(motor, device, axes, known), [motor, device, axes, known]);
  const [solid, setSolid] = useState(false);
  const still = useMedia("(prefers-reduced-motion: reduce)");
  const [frame, setFrame] = useState<Frame>("stator");
  if (!motor) {
    return null;
  }
  return (
    <section class="panel motion" aria-label={t("Motion of {axis}", { axis })}>
      <header>
        <h2>{t("Motion of {axis}", { axis })}</h2>
        <span class="spacer" />
        <button type="button" aria-pressed={solid} onClick={() => setSolid(!solid)}>
          {t("Show in 3-D")}
        </button>
        {still ? null : (
          <div class="segmented" role="group" aria-label={t("What stands still in the picture")}>
            <button type="button" aria-pressed={frame === "stator"} onClick={() => setFrame("stator")}>
              {t("stator")}
            </button>
            <button type="button" aria-pressed={frame === "rotor"} onClick={() => setFrame("rotor")}>
              {motor.kind === "servo" ? t("d/q at rest") : t("rotor at rest")}
            </button>
          </div>
        )}
      </header>
      <div class="body">
        {still ? (
          <p class="soft">{t("Numbers only, as your system asks for little motion.")}</p>
        ) : (
          <div>
            <MotorPicture motor={motor} title={axis} frame={frame} />
          </div>
        )}
        <MotorNumbers motor={motor} />
        {solid ? <MachineView device={device} motors={machine} /> : null}
      </div>
    </section>
  );
}

/// Three axes are a gantry, any other number is a rotary table each.
function machineOf(motor: MotorSignals | null, device: string, axes: readonly string[], known: ReadonlySet<string>): MotorSignals[] {
  const all = axes.flatMap((each) => motorSignals(device, each, known) ?? []);
  return all.length === 3 ? all : motor ? [motor] : [];
}

function MotorNumbers({ motor }: { motor: MotorSignals }) {
  const { hub } = useWorld();
  useEffect(() => hub.watch(motor.names), [hub, motor]);
  const shown = useShownIn();
  const numbers = useMemo(() => computed(() => motorNumbers(motor, (name) => shown(name, hub.live(name).value))), [hub, motor, shown]);
  const labels = useMemo(() => computed(() => numbers.value.map(({ label }) => label).join("\n")), [numbers]);
  return (
    <dl class="numbers">
      {labels.value.split("\n").map((label, i) => (
        <div key={`${i} ${label}`}>
          <dt>{label}</dt>
          <dd>
            <NumberText numbers={numbers} row={i} />
          </dd>
        </div>
      ))}
    </dl>
  );
}

/// Repaints its own text alone.
function NumberText({ numbers, row }: { numbers: ReadonlySignal<readonly MotorNumber[]>; row: number }) {
  const text = useMemo(() => computed(() => numbers.value[row]?.text ?? ""), [numbers, row]);
  return <>{text}</>;
}
