// Stator current, voltage and rotor of a motor as vectors, from the signals that its device has.
import { quantityText } from "./format";
import { t } from "./language";
import type { Live } from "./live";

export interface Polar {
  readonly length: number;
  /// rad, electrical, ahead of the rotor's flux.
  readonly angle: number;
}

/// What a picture of a motor shows at one moment.
export interface MotorState {
  /// rad, electrical, of the rotor's flux ahead of the first coil. Null: nothing tells.
  readonly rotor: number | null;
  readonly current: Polar;
  readonly voltage: Polar | null;
}

export type Read = (signal: string) => Live | undefined;

export interface MotorSignals {
  readonly kind: "stepper" | "servo";
  readonly prefix: string;
  /// Of the shaft's position in revolutions and its speed.
  readonly shaft: string;
  readonly speed: string;
  readonly names: readonly string[];
  /// The stator's coils and where their axes lie, electrical degrees.
  readonly coils: readonly (readonly [string, number])[];
}

const kTorques = ["torque", "load_torque"];
// Of devices, and of motors on a board.
const kSteppers = [
  ["coil_current_a", "coil_current_b", "load_angle"],
  ["current_a", "current_b", "load_angle"],
];
const kServo = ["direct_current", "quadrature_current"];
const kPhases = [
  ["current_u", "current_v", "current_w"],
  ["phase_current_u", "phase_current_v", "phase_current_w"],
];
const kStage = ["current_y2", "duty_u", "duty_v", "duty_w", "duty_y2", "enable_out", "supply_voltage"];

/// Below this current, in A, a stator has no field to speak of.
const kNoCurrent = 0.01;

/// The signals of `device`'s `axis` that make a picture; null: it has none that do.
export function motorSignals(device: string, axis: string, known: ReadonlySet<string>): MotorSignals | null {
  const prefix = `${device}.${axis}.`;
  const have = (names: readonly string[]) => names.filter((name) => known.has(prefix + name)).map((name) => prefix + name);
  const [shaft] = have(["shaft_position", "position"]);
  const [speed] = have(["shaft_speed", "speed"]);
  if (shaft === undefined || speed === undefined) {
    return null;
  }
  const common = { prefix, shaft, speed };
  const stepper = kSteppers.find((names) => have(names).length === names.length);
  if (stepper) {
    const coils = [
      ["A", 0],
      ["B", 90],
    ] as const;
    return { kind: "stepper", ...common, names: [shaft, speed, ...have([...kTorques, ...stepper])], coils };
  }
  const phases = kPhases.find((names) => have(names).length === names.length);
  if (phases && have(kServo).length === kServo.length) {
    const coils = [
      ["U", 0],
      ["V", 120],
      ["W", 240],
    ] as const;
    return { kind: "servo", ...common, names: [shaft, speed, ...have([...kTorques, ...kServo, ...phases, ...kStage])], coils };
  }
  return null;
}

/// -pi … pi
export function wrapped(angle: number): number {
  return angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));
}

export function radians(live: Live | undefined): number {
  const value = live?.value ?? 0;
  return live?.unit === "rad" ? value : (value * Math.PI) / 180;
}

export function degrees(angle: number): number {
  return (angle * 180) / Math.PI;
}

function polar(x: number, y: number): Polar {
  return { length: Math.hypot(x, y), angle: Math.atan2(y, x) };
}

export function motorState(motor: MotorSignals, read: Read): MotorState {
  const value = (name: string) => read(motor.prefix + name)?.value;
  if (motor.kind === "stepper") {
    const field = polar(value("coil_current_a") ?? value("current_a") ?? 0, value("coil_current_b") ?? value("current_b") ?? 0);
    const load = radians(read(`${motor.prefix}load_angle`));
    return {
      rotor: field.length < kNoCurrent ? null : wrapped(field.angle - load),
      current: { length: field.length, angle: load },
      voltage: null,
    };
  }
  // Seen from the stator and from the rotor the current is the same; between the two views lies the rotor's angle.
  const current = polar(value("direct_current") ?? 0, value("quadrature_current") ?? 0);
  const phase = (name: string) => value(`current_${name}`) ?? value(`phase_current_${name}`) ?? 0;
  const field = statorVector(phase("u"), phase("v"), phase("w"), value("current_y2") ?? 0);
  const rotor = field === null || field.length < kNoCurrent || current.length < kNoCurrent ? null : wrapped(field.angle - current.angle);
  return { rotor, current, voltage: rotor === null ? null : stageVoltage(motor, read, rotor) };
}

/// The vector of three phases, by the amplitude-invariant transformation, or of two between u and v, w and y2. Null: two
/// half bridges, as of a DC motor, in which nothing turns.
function statorVector(u: number, v: number, w: number, y2: number): Polar | null {
  if (w === 0 && y2 === 0) {
    return u === 0 && v === 0 ? polar(0, 0) : null;
  }
  return y2 === 0 ? polar((2 * u - v - w) / 3, (v - w) / Math.sqrt(3)) : polar((u - v) / 2, (w - y2) / 2);
}

/// What the duties of the half bridges put to the coils.
function stageVoltage(motor: MotorSignals, read: Read, rotor: number): Polar | null {
  const value = (name: string) => read(motor.prefix + name)?.value ?? null;
  const [u, v, w, y2, supply] = [value("duty_u"), value("duty_v"), value("duty_w"), value("duty_y2") ?? 0, value("supply_voltage")];
  if (u === null || v === null || w === null || supply === null) {
    return null;
  }
  if (value("enable_out") === 0) {
    return { length: 0, angle: 0 };
  }
  const stator = statorVector(u, v, w, y2);
  // A coil between two half bridges has the voltage of both.
  const volts = supply * (y2 === 0 ? 1 : 2);
  return stator && { length: stator.length * volts, angle: wrapped(stator.angle - rotor) };
}

/// The angle by which a picture turns. A motor that turns so fast that moments 40 ms apart tell nothing of its way is shown
/// slowed, in its direction; what vectors have between them stays as it is.
export class Turning {
  /// rad
  shown = 0;
  slowed = false;
  private fresh = true;

  /// rev/s of the shaft above which it is slowed.
  constructor(private readonly limit: number) {}

  /// `seconds` after the last time. False: the picture is where it belongs, and stays.
  advance(angle: number, speed: number, seconds: number): boolean {
    this.slowed = Math.abs(speed) > this.limit;
    const step = Math.min(seconds, 0.1);
    if (this.fresh) {
      this.fresh = false;
      this.shown = angle;
      return true;
    }
    if (this.slowed) {
      this.shown = wrapped(this.shown + Math.sign(speed) * kShownRate * 2 * Math.PI * step);
      return true;
    }
    const rest = wrapped(angle - this.shown);
    if (Math.abs(rest) < 1e-3) {
      return false;
    }
    this.shown = wrapped(this.shown + rest * (1 - Math.exp(-step / kEase)));
    return true;
  }
}

const kShownRate = 0.25; ///< turns of the field per second in a picture that is slowed
const kEase = 0.05; ///< s in which a picture follows what it is told 25 times a second

/// rev/s
export function shaftSpeed(motor: MotorSignals, read: Read): number {
  const live = read(motor.speed);
  return (live?.value ?? 0) / (live?.unit === "1/min" ? 60 : 1);
}

/// rev/s of a shaft up to which its field is shown as it is: 50 and some pole pairs let the field turn once a second.
export function slowLimit(kind: MotorSignals["kind"]): number {
  return kind === "stepper" ? 0.02 : 0.2;
}

export interface MotorNumber {
  readonly label: string;
  readonly text: string;
}

function angleText(angle: number): string {
  return `${degrees(angle).toFixed(1).replace("-", "−")}°`;
}

export function vectorText(name: string, vector: Polar, unit: string): string {
  return t("{vector}: {length} at {angle} electrical to the rotor's flux", {
    vector: name,
    length: quantityText(vector.length, unit),
    angle: angleText(vector.angle),
  });
}

/// The same as numbers, for those who do not see the picture.
export function motorNumbers(motor: MotorSignals, read: Read): MotorNumber[] {
  const state = motorState(motor, read);
  const rows: MotorNumber[] = [];
  const add = (label: string, name: string, digits?: number) => {
    const live = read(name.startsWith(motor.prefix) ? name : motor.prefix + name);
    if (live) {
      rows.push({ label, text: quantityText(live.value, live.unit, digits) });
    }
  };
  add(t("Shaft"), motor.shaft, 6);
  add(t("Speed"), motor.speed);
  add(t("Torque"), "torque");
  add(t("Load torque"), "load_torque");
  rows.push({ label: t("Stator current"), text: quantityText(state.current.length, "A") });
  if (motor.kind === "stepper") {
    for (const coil of ["a", "b"]) {
      add(t("Coil {coil}", { coil: coil.toUpperCase() }), `coil_current_${coil}`);
      add(t("Coil {coil}", { coil: coil.toUpperCase() }), `current_${coil}`);
    }
    if (state.rotor === null) {
      rows.push({ label: t("Load angle"), text: t("no field") });
    } else {
      const left = 90 - Math.abs(degrees(state.current.angle));
      rows.push({ label: t("Load angle"), text: t("{angle} el.", { angle: angleText(state.current.angle) }) });
      rows.push({ label: t("To pull-out"), text: left > 0 ? t("{angle} el.", { angle: `${left.toFixed(1)}°` }) : t("beyond") });
    }
    return rows;
  }
  add(t("Direct current"), "direct_current");
  add(t("Quadrature current"), "quadrature_current");
  for (const phase of ["u", "v", "w"]) {
    add(t("Phase {phase}", { phase: phase.toUpperCase() }), `current_${phase}`);
    add(t("Phase {phase}", { phase: phase.toUpperCase() }), `phase_current_${phase}`);
  }
  if (state.voltage) {
    rows.push({ label: t("Stator voltage"), text: quantityText(state.voltage.length, "V") });
    rows.push({ label: t("Direct voltage"), text: quantityText(state.voltage.length * Math.cos(state.voltage.angle), "V") });
    rows.push({ label: t("Quadrature voltage"), text: quantityText(state.voltage.length * Math.sin(state.voltage.angle), "V") });
  }
  rows.push({
    label: t("Rotor flux at"),
    text: state.rotor === null ? t("no current tells") : t("{angle} el.", { angle: angleText(state.rotor) }),
  });
  return rows;
}
