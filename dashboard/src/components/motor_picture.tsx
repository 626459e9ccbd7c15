// A motor in section: its shaft, and the stator's vectors with the rotor among them, turning as the signals say.
import { useEffect, useRef, useState } from "preact/hooks";

import { quantityText } from "../format";
import { useSignals, useWorld } from "../hooks";
import { t } from "../language";
import {
  degrees,
  motorState,
  shaftSpeed,
  slowLimit,
  Turning,
  vectorText,
  wrapped,
  type MotorSignals,
  type MotorState,
  type Polar,
} from "../motion";
import { rangeFor } from "./gauge";
import { ShaftDial } from "./shaft";

export type Frame = "stator" | "rotor";

const kWidth = 380;
const kHeight = 250;
const kX = 246;
const kY = 125;
const kRadius = 104;
const kCoilLabel = kRadius + 11;
const kRotorLabel = kRadius - 13;
const kBeside = 0.11; ///< rad by which names of axes stand beside them
const kLoadRadius = kRadius * 0.44;
const kEase = 0.06; ///< s in which vectors follow

function at(radius: number, angle: number): [number, number] {
  return [kX + radius * Math.cos(angle), kY - radius * Math.sin(angle)];
}

function turn(angle: number): string {
  return `rotate(${(-degrees(angle)).toFixed(2)} ${kX} ${kY})`;
}

/// The way of the load angle, from the rotor to the current, in the frame of the rotor.
function arc(angle: number): string {
  const [x, y] = at(kLoadRadius, angle);
  return `M${kX + kLoadRadius} ${kY}A${kLoadRadius} ${kLoadRadius} 0 0 ${angle > 0 ? 0 : 1} ${x.toFixed(1)} ${y.toFixed(1)}`;
}

/// What the picture's elements follow, brought to them frame by frame past the components.
class Drawing {
  private readonly turning: Turning;
  private current: Polar = { length: 0, angle: 0 };
  private voltage: Polar = { length: 0, angle: 0 };
  private seenCurrent = 0;
  private seenVoltage = 0;
  private last = 0;
  private readonly parts = new Map<string, SVGElement>();

  constructor(
    svg: SVGSVGElement,
    private readonly motor: MotorSignals,
  ) {
    this.turning = new Turning(slowLimit(motor.kind));
    for (const each of svg.querySelectorAll<SVGElement>("[data-part]")) {
      this.parts.set(each.dataset["part"] ?? "", each);
    }
  }

  private element(part: string): SVGElement | undefined {
    return this.parts.get(part);
  }

  /// False: nothing moves any more until the next values.
  draw(state: MotorState, speed: number, frame: Frame, now: number): boolean {
    const seconds = this.last === 0 ? 0.04 : (now - this.last) / 1000;
    this.last = now;
    const turns = state.rotor !== null && this.turning.advance(state.rotor, speed, seconds);
    const follows = this.follow("current", state.current, seconds);
    const followsToo = state.voltage !== null && this.follow("voltage", state.voltage, seconds);
    const angle = this.turning.shown;
    const [rotor, stator] = frame === "stator" ? [angle, 0] : [Math.PI / 2, Math.PI / 2 - angle];
    this.element("rotor")?.setAttribute("transform", turn(rotor));
    this.element("stator")?.setAttribute("transform", turn(stator));
    this.place("d", kRotorLabel, rotor - kBeside);
    this.place("q", kRotorLabel, rotor + Math.PI / 2 - kBeside);
    for (const [name, position] of this.motor.coils) {
      this.place(name, kCoilLabel, stator + (position * Math.PI) / 180);
    }
    this.element("rotor")?.classList.toggle("unknown", state.rotor === null);
    this.seenCurrent = Math.max(this.seenCurrent, this.current.length);
    const most = rangeFor({ low: 0, high: this.seenCurrent }).maximum;
    this.arrow("current", this.current, most, "A");
    if (state.voltage) {
      this.seenVoltage = Math.max(this.seenVoltage, this.voltage.length);
      this.arrow("voltage", this.voltage, rangeFor({ low: 0, high: this.seenVoltage }).maximum, "V");
    }
    this.element("voltage")?.setAttribute("visibility", state.voltage ? "visible" : "hidden");
    const load = this.element("load");
    if (load) {
      load.setAttribute("d", state.rotor === null ? "" : arc(this.current.angle));
      load.classList.toggle("beyond", Math.abs(this.current.angle) > Math.PI / 2);
      const label = this.element("load-text");
      if (label) {
        const [x, y] = at(kLoadRadius + 16, rotor + this.current.angle / 2);
        label.setAttribute("x", x.toFixed(1));
        label.setAttribute("y", (y + 4).toFixed(1));
        label.textContent = state.rotor === null ? "" : `${degrees(this.current.angle).toFixed(0).replace("-", "−")}°`;
      }
    }
    const slowed = state.rotor !== null && this.turning.slowed ? t("The field is shown slowed.") : "";
    const note = this.element("slowed");
    if (note && note.textContent !== slowed) {
      note.textContent = slowed;
    }
    return turns || follows || followsToo;
  }

  private follow(which: "current" | "voltage", target: Polar, seconds: number): boolean {
    const part = 1 - Math.exp(-Math.min(seconds, 0.1) / kEase);
    const own = this[which];
    const angle = wrapped(target.angle - own.angle);
    const length = target.length - own.length;
    if (Math.abs(angle) < 1e-3 && Math.abs(length) < 1e-3 * Math.max(target.length, 1e-3)) {
      this[which] = target;
      return false;
    }
    this[which] = { length: own.length + length * part, angle: wrapped(own.angle + angle * part) };
    return true;
  }

  private place(part: string, radius: number, angle: number): void {
    const element = this.element(part);
    if (element) {
      const [x, y] = at(radius, angle);
      element.setAttribute("x", x.toFixed(1));
      element.setAttribute("y", (y + 4).toFixed(1));
    }
  }

  private arrow(part: "current" | "voltage", vector: Polar, most: number, unit: string): void {
    const element = this.element(part);
    element?.setAttribute("transform", turn(vector.angle));
    const end = (kX + (kRadius * vector.length) / most).toFixed(1);
    for (const line of element?.querySelectorAll("line") ?? []) {
      line.setAttribute("x2", end);
    }
    const scale = this.element(`${part}-scale`);
    const text = t("circle: {radius}", { radius: quantityText(most, unit) });
    if (scale && scale.textContent !== text) {
      scale.textContent = text;
    }
  }
}

export function MotorPicture({ motor, title, frame }: { motor: MotorSignals; title: string; frame: Frame }) {
  const { hub } = useWorld();
  const svg = useRef<SVGSVGElement>(null);
  const [chosen, setChosen] = useState<"current" | "voltage" | "flux" | null>(null);
  useEffect(() => {
    if (!svg.current) {
      return undefined;
    }
    const drawing = new Drawing(svg.current, motor);
    let request = 0;
    const draw = (now: number) => {
      const state = motorState(motor, (name) => hub.value(name));
      const speed = shaftSpeed(motor, (name) => hub.value(name));
      request = drawing.draw(state, speed, frame, now) ? requestAnimationFrame(draw) : 0;
    };
    const begin = () => {
      if (request === 0) {
        request = requestAnimationFrame(draw);
      }
    };
    const stop = hub.watch(motor.names, begin);
    begin();
    return () => {
      stop();
      cancelAnimationFrame(request);
    };
  }, [hub, motor, frame]);
  const choose = (which: "current" | "voltage" | "flux") => ({
    tabIndex: 0,
    onMouseEnter: () => setChosen(which),
    onMouseLeave: () => setChosen(null),
    onFocus: () => setChosen(which),
    onBlur: () => setChosen(null),
  });
  const stepper = motor.kind === "stepper";
  const reach = kX + kRadius;
  return (
    <>
      <svg
        ref={svg}
        class="motor"
        viewBox={`0 0 ${kWidth} ${kHeight}`}
        role="group"
        aria-label={t("Shaft and field of {title}; the numbers follow", { title })}
      >
        <defs>
          {["current", "voltage"].map((kind) => (
            <marker
              key={kind}
              id={`head-${kind}`}
              class={kind}
              viewBox="0 0 8 8"
              refX="6"
              refY="4"
              markerWidth="9"
              markerHeight="9"
              markerUnits="userSpaceOnUse"
              orient="auto"
            >
              <path d="M0 0.5L8 4L0 7.5Z" />
            </marker>
          ))}
        </defs>
        <g aria-hidden="true">
          <ShaftDial signal={motor.shaft} x={62} y={kY} radius={50} />
          <text class="small" x={62} y={kY + 68}>
            {t("shaft")}
          </text>
          <circle class="field" cx={kX} cy={kY} r={kRadius} />
          <g data-part="stator" class="coils">
            {motor.coils.map(([name, position]) => {
              const angle = (position * Math.PI) / 180;
              const [x1, y1] = stepper ? at(-kRadius, angle) : [kX, kY];
              const [x2, y2] = at(kRadius, angle);
              return <line key={name} x1={x1} y1={y1} x2={x2} y2={y2} />;
            })}
          </g>
          {motor.coils.map(([name]) => (
            <text key={name} data-part={name} class="coil">
              {name}
            </text>
          ))}
        </g>
        <g data-part="rotor">
          <g class="vector flux" role="img" aria-label={t("Rotor flux: the d axis")} {...choose("flux")}>
            <rect class="south" x={kX - kRadius * 0.3} y={kY - 11} width={kRadius * 0.3} height={22} />
            <rect class="north" x={kX} y={kY - 11} width={kRadius * 0.3} height={22} />
            <line class="axis" x1={kX} y1={kY} x2={reach} y2={kY} />
          </g>
          {stepper ? (
            <path class="pull-out" d={`M${kX} ${kY - kRadius}V${kY + kRadius}`}>
              <title>{t("The current may be 90° electrical ahead of the rotor or behind it; beyond, the rotor is pulled out")}</title>
            </path>
          ) : (
            <line class="axis" x1={kX} y1={kY} x2={kX} y2={kY - kRadius} />
          )}
          {stepper ? <path data-part="load" class="load" d="" /> : null}
          {stepper ? null : (
            <g class="vector voltage" data-part="voltage" role="img" aria-label={t("Stator voltage")} {...choose("voltage")}>
              <line class="grip" x1={kX} y1={kY} x2={kX} y2={kY} />
              <line class="shown" x1={kX} y1={kY} x2={kX} y2={kY} marker-end="url(#head-voltage)" />
            </g>
          )}
          <g class="vector current" data-part="current" role="img" aria-label={t("Stator current")} {...choose("current")}>
            <line class="grip" x1={kX} y1={kY} x2={kX} y2={kY} />
            <line class="shown" x1={kX} y1={kY} x2={kX} y2={kY} marker-end="url(#head-current)" />
          </g>
        </g>
        <g aria-hidden="true">
          <text data-part="d" class="axis-name">
            {stepper ? "N" : "d"}
          </text>
          {stepper ? (
            <text data-part="load-text" class="load-text" />
          ) : (
            <text data-part="q" class="axis-name">
              q
            </text>
          )}
          <text data-part="current-scale" class="scale current" x={4} y={16} />
          {stepper ? null : <text data-part="voltage-scale" class="scale voltage" x={4} y={32} />}
          <text data-part="slowed" class="scale" x={4} y={kHeight - 6} />
        </g>
      </svg>
      <Readout motor={motor} chosen={chosen} />
    </>
  );
}

/// What the vector that a person points at is, in numbers.
function Readout({ motor, chosen }: { motor: MotorSignals; chosen: "current" | "voltage" | "flux" | null }) {
  const read = useSignals(chosen === null ? [] : motor.names, 150);
  const state = motorState(motor, read);
  const text =
    chosen === "current"
      ? vectorText(t("Stator current"), state.current, "A")
      : chosen === "voltage" && state.voltage
        ? vectorText(t("Stator voltage"), state.voltage, "V")
        : chosen === "flux"
          ? state.rotor === null
            ? t("Rotor: without current nothing tells where it stands")
            : t("Rotor flux: at {angle} electrical from coil {coil}", {
                angle: `${degrees(state.rotor).toFixed(1).replace("-", "−")}°`,
                coil: motor.coils[0]?.[0] ?? "",
              })
          : t("Point at a vector, or focus it, for its numbers.");
  return <p class="readout soft">{text}</p>;
}
