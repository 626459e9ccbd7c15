// Positions and velocities of motors in the unit that a person has chosen: one choice for all views, kept for the next visit. The
// page's address has it too (router.ts).
import { signal } from "@preact/signals";

import type { Device } from "./api";
import { grouped, kNone, unitText } from "./format";
import { t } from "./language";

export type MotionUnit = "revolutions" | "degrees" | "radians" | "device";
type Dimension = "position" | "velocity";

/// What a revolution is to a device, and a velocity of one per second; null: not known.
export type PerRevolution = Device["per_revolution"];

interface UnitDeclaration {
  readonly unit: MotionUnit;
  readonly name: string;
  /// Units as signals name them.
  readonly position: string;
  readonly velocity: string;
  /// Of one revolution; null: as many as the device says.
  readonly perRevolution: number | null;
  /// Behind the point, of what is shown.
  readonly decimals: number;
}

/// The usual one first.
export const kUnits: readonly UnitDeclaration[] = [
  { unit: "revolutions", name: t("revolutions"), position: "rev", velocity: "rev/s", perRevolution: 1, decimals: 3 },
  { unit: "degrees", name: t("degrees"), position: "deg", velocity: "deg/s", perRevolution: 360, decimals: 1 },
  { unit: "radians", name: t("radians (SI)"), position: "rad", velocity: "rad/s", perRevolution: 2 * Math.PI, decimals: 3 },
  { unit: "device", name: t("device units (steps)"), position: t("units"), velocity: t("units"), perRevolution: null, decimals: 0 },
];
export const kUsualUnit: MotionUnit = "revolutions";

const kKey = "stator.units";

export function unitNamed(name: string | null | undefined): MotionUnit | null {
  return kUnits.find(({ unit }) => unit === name)?.unit ?? null;
}

export const motionUnit = signal<MotionUnit>(
  (typeof localStorage === "undefined" ? null : unitNamed(localStorage.getItem(kKey))) ?? kUsualUnit,
);

export function rememberUnit(unit: MotionUnit): void {
  motionUnit.value = unit;
  localStorage.setItem(kKey, unit);
}

export function declarationOf(unit: MotionUnit): UnitDeclaration {
  return kUnits.find((each) => each.unit === unit) as UnitDeclaration;
}

/// The units in which positions and velocities of motors come, and how many there are in a revolution, or in one per second; null: as
/// many as the device says. Electrical angles and counts of an encoder are none.
const kDeclared: Readonly<Record<string, readonly [Dimension, number | null]>> = {
  rev: ["position", 1],
  microstep: ["position", null],
  microsteps: ["position", null],
  increment: ["position", null],
  increments: ["position", null],
  "rev/s": ["velocity", 1],
  "1/min": ["velocity", 60],
  rpm: ["velocity", 60],
  pps: ["velocity", null],
};

export interface Conversion {
  readonly unit: string;
  readonly factor: number;
}

/// From what is declared in `declared` to how it is shown; what is no position or velocity, or comes from a device that does not tell
/// what a revolution is, stays as it is.
export function conversion(chosen: MotionUnit, declared: string, perRevolution: PerRevolution): Conversion {
  const [dimension, known] = kDeclared[declared] ?? [null, null];
  const shown = declarationOf(chosen);
  const size = dimension === null ? null : (known ?? perRevolution?.[dimension] ?? null);
  return dimension === null || size === null || shown.perRevolution === null
    ? { unit: declared, factor: 1 }
    : { unit: shown[dimension], factor: shown.perRevolution / size };
}

interface AxisUnits {
  readonly position_per_revolution: number | null;
  readonly velocity_per_revolution: number | null;
}

/// Those in which all `axes` can be shown.
export function unitsOf(axes: readonly AxisUnits[]): readonly UnitDeclaration[] {
  const known = axes.every((axis) => axis.position_per_revolution && axis.velocity_per_revolution);
  return kUnits.filter((each) => known || each.perRevolution === null);
}

/// One dimension of an axis in the unit chosen: `perRevolution` is what the device has for a revolution, or one per second.
export class Scale {
  private readonly factor: number;
  private readonly declaration: UnitDeclaration;
  readonly name: string;

  constructor(unit: MotionUnit, dimension: Dimension, perRevolution: number | null) {
    this.declaration = declarationOf(unit);
    this.name = unitText(this.declaration[dimension]);
    this.factor = this.declaration.perRevolution === null ? 1 : (perRevolution ?? 1) / this.declaration.perRevolution;
  }
  /// Devices hold whole numbers.
  toDevice(value: number): number {
    return Math.round(value * this.factor);
  }
  /// As it is shown, with a fixed number of decimals so that it stands still while it changes.
  text(device: number | null): string {
    if (device === null) {
      return kNone;
    }
    const text = (device / this.factor).toFixed(this.declaration.decimals);
    return grouped(/^-0(\.0*)?$/.test(text) ? text.slice(1) : text);
  }
  /// As it stands in a field.
  field(device: number): string {
    return String(Number((device / this.factor).toPrecision(7)));
  }
}

/// What a person typed; a comma is as good as a point. Null: no number.
export function numberOf(text: string): number | null {
  const plain = text.trim().replace("−", "-").replace(",", ".");
  const value = Number(plain);
  return plain === "" || !Number.isFinite(value) ? null : value;
}
