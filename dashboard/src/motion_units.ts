// Positions and velocities of an axis in the units of its device, in revolutions and in degrees.
import type { ManualAxis } from "./api";
import { grouped, kNone } from "./format";

export type MotionUnit = "device" | "revolutions" | "degrees";

interface UnitDeclaration {
  readonly unit: MotionUnit;
  readonly name: string;
  readonly position: string;
  readonly velocity: string;
  /// Of one revolution; null: as many as the device says.
  readonly perRevolution: number | null;
  /// Behind the point, of what is shown.
  readonly decimals: number;
}

const kUnits: readonly UnitDeclaration[] = [
  { unit: "revolutions", name: "revolutions", position: "rev", velocity: "rev/s", perRevolution: 1, decimals: 3 },
  { unit: "degrees", name: "degrees", position: "°", velocity: "°/s", perRevolution: 360, decimals: 1 },
  { unit: "device", name: "device units", position: "units", velocity: "units", perRevolution: null, decimals: 0 },
];

export function declarationOf(unit: MotionUnit): UnitDeclaration {
  return kUnits.find((each) => each.unit === unit) as UnitDeclaration;
}

/// Those in which all `axes` can be shown, the most telling first.
export function unitsOf(axes: readonly ManualAxis[]): readonly UnitDeclaration[] {
  const known = axes.every((axis) => axis.position_per_revolution && axis.velocity_per_revolution);
  return kUnits.filter((each) => known || each.perRevolution === null);
}

/// One dimension of an axis in the unit chosen: `perRevolution` is what the device has for a revolution, or one per second.
export class Scale {
  private readonly factor: number;
  private readonly declaration: UnitDeclaration;
  readonly name: string;

  constructor(unit: MotionUnit, dimension: "position" | "velocity", perRevolution: number | null) {
    this.declaration = declarationOf(unit);
    this.name = this.declaration[dimension];
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
