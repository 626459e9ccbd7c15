// Which signals tell how shafts stand. Every shaft has one in revolutions.

import type { Signal } from "./api";

export interface Shaft {
  readonly device: string;
  readonly name: string; ///< e.g. "axis0", "fan"
  readonly signal: string;
}

export function shaftsOf(signals: readonly Signal[], devices: readonly string[]): Shaft[] {
  const shafts: Shaft[] = [];
  for (const { name, unit } of signals) {
    const device = devices
      .filter((each) => name.startsWith(`${each}.`))
      .reduce((best, each) => (each.length > best.length ? each : best), "");
    if (device === "" || unit !== "rev") {
      continue;
    }
    const rest = name.slice(device.length + 1);
    const end = rest.lastIndexOf(".");
    if (end > 0 && !rest.slice(end).includes("demand")) {
      shafts.push({ device, name: rest.slice(0, end), signal: name });
    }
  }
  return shafts;
}

/// Degrees of a position in revolutions, 0 … 360.
export function shaftDegrees(revolutions: number): number {
  const part = revolutions - Math.floor(revolutions);
  return part * 360;
}
