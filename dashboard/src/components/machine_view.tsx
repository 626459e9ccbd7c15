// The axes of a device as a machine in three dimensions, whose program is loaded when it is first shown.
import { useEffect, useRef, useState } from "preact/hooks";

import { quantityText } from "../format";
import { useLive, useMedia, useShownIn, useWorld } from "../hooks";
import { t } from "../language";
import type { MotorSignals } from "../motion";
import type { Machine } from "../scene/machine";

const kNames = ["x", "y", "z"];

/// `motors`: one, or the three of a gantry.
export function MachineView({ device, motors }: { device: string; motors: readonly MotorSignals[] }) {
  const { hub } = useWorld();
  const canvas = useRef<HTMLCanvasElement>(null);
  const legend = useRef<HTMLDListElement>(null);
  const [problem, setProblem] = useState("");
  const dark = useMedia("(prefers-color-scheme: dark)");
  const key = motors.map((motor) => motor.shaft).join("\n");
  useEffect(() => {
    let over = false;
    let machine: Machine | null = null;
    let stop = () => {};
    const resized = new ResizeObserver(([found]) => {
      if (found && found.contentRect.width > 0) {
        machine?.resize(found.contentRect.width, found.contentRect.height);
      }
    });
    const show = async () => {
      const { Machine } = await import("../scene/machine");
      const element = canvas.current;
      if (over || !element) {
        return;
      }
      const colours = [...(legend.current?.querySelectorAll(".swatch") ?? [])].map((each) => getComputedStyle(each).backgroundColor);
      machine = new Machine(element, colours.length, { frame: getComputedStyle(element).color, axes: colours });
      resized.observe(element);
      const signals = key.split("\n");
      const told = () => machine?.set(signals.map((signal) => hub.value(signal)?.value ?? 0));
      stop = hub.watch(signals, told);
    };
    show().catch((error: unknown) => {
      if (!over) {
        const reason = error instanceof Error ? error.message : String(error);
        setProblem(t("The machine cannot be drawn: {reason}.", { reason: reason.replace(/^THREE\.\w+: /, "").replace(/\.$/, "") }));
      }
    });
    return () => {
      over = true;
      stop();
      resized.disconnect();
      machine?.dispose();
    };
  }, [hub, key, dark]);
  const gantry = motors.length >= 3;
  return (
    <div class="machine-view">
      {problem === "" ? (
        <>
          <canvas
            key={`${key} ${dark}`}
            ref={canvas}
            tabIndex={0}
            role="img"
            aria-label={
              gantry
                ? t("A gantry that moves as the shafts of {device} do. Arrow keys turn the view, plus and minus zoom, Home puts it back.", {
                    device,
                  })
                : t(
                    "A rotary table that moves as the shaft of {device} does. Arrow keys turn the view, plus and minus zoom, Home puts it back.",
                    { device },
                  )
            }
          />
          <p class="soft">{t("Drag to turn the view, pinch to zoom; with the focus on it the wheel, arrow keys, + and − do so, too.")}</p>
        </>
      ) : (
        <p class="notice warning" role="status">
          {t("{problem} It needs WebGL, which this browser lacks or has switched off. The numbers are here all the same.", { problem })}
        </p>
      )}
      <dl class="numbers" ref={legend}>
        {motors.map((motor, i) => {
          const axis = motor.prefix.slice(device.length + 1, -1);
          return <AxisNumbers key={motor.prefix} motor={motor} name={gantry ? `${kNames[i] ?? ""} (${axis})` : axis} series={i + 1} />;
        })}
      </dl>
      {gantry ? (
        <p class="soft">
          {t("How far a revolution goes is the machine’s affair, not the module’s: each axis is drawn to the scale of its way so far.")}
        </p>
      ) : null}
    </div>
  );
}

function AxisNumbers({ motor, name, series }: { motor: MotorSignals; name: string; series: number }) {
  const shown = useShownIn();
  const position = shown(motor.shaft, useLive(motor.shaft).value);
  const speed = shown(motor.speed, useLive(motor.speed).value);
  return (
    <div>
      <dt>
        <span class={`swatch series-${series}`} aria-hidden="true" /> {name}
      </dt>
      <dd>
        {quantityText(position?.value, position?.unit ?? "", 5)} · {quantityText(speed?.value, speed?.unit ?? "")}
      </dd>
    </div>
  );
}
