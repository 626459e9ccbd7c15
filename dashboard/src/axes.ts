// Which signals show what of an axis. The server's panel names them; the names the products use are
// the second choice.

import type { PanelAxis, Signal } from "./api";
import { t } from "./language";

export interface AxisSignals {
  readonly name: string;
  readonly rows: readonly { readonly label: string; readonly signal: string }[];
}

const kRows: readonly [string, string, readonly string[]][] = [
  ["position", t("Position"), ["position_actual", "shaft_position", "position", "count"]],
  ["position_demand", t("Position demand"), ["position_demand", "position_target"]],
  ["following_error", t("Following error"), ["following_error"]],
  ["velocity", t("Velocity"), ["velocity_actual", "shaft_speed", "speed"]],
  ["shaft_speed", t("Shaft speed"), ["shaft_speed"]],
  ["current", t("Current"), ["quadrature_current", "current_actual", "coil_current_a", "current", "current_a"]],
  ["torque", t("Torque"), ["torque"]],
  ["load", t("Load torque"), ["load_torque"]],
  ["supply", t("Supply"), ["supply_voltage"]],
  ["temperature", t("Winding"), ["winding_temperature"]],
  ["driver_temperature", t("Power stage"), ["driver_temperature"]],
];

/// "gantry.axis0.torque" of "gantry" belongs to "axis0".
export function axisOf(signal: string, device: string): string {
  const rest = signal.slice(device.length + 1);
  const dot = rest.lastIndexOf(".");
  return dot < 0 ? "" : rest.slice(0, dot);
}

export function axesOf(device: string, signals: readonly Signal[], panel: readonly PanelAxis[]): AxisSignals[] {
  const own = signals.map(({ name }) => name).filter((name) => name.startsWith(`${device}.`));
  const known = new Set(own);
  const names = panel.length > 0 ? panel.map((axis) => axis.name) : [];
  for (const name of own) {
    const axis = axisOf(name, device);
    if (
      axis !== "" &&
      !names.includes(axis) &&
      (known.has(`${device}.${axis}.shaft_position`) || known.has(`${device}.${axis}.position`))
    ) {
      names.push(axis);
    }
  }
  return names.map((axis) => {
    const told = panel.find((each) => each.name === axis)?.signals ?? {};
    const taken = new Set<string>();
    const rows = kRows.flatMap(([key, label, endings]) => {
      const candidates = [told[key], ...endings.map((ending) => `${device}.${axis}.${ending}`)];
      const signal = candidates.find((each) => each !== undefined && known.has(each));
      if (signal === undefined || taken.has(signal)) {
        return [];
      }
      taken.add(signal);
      return [{ label, signal }];
    });
    return { name: axis, rows };
  });
}

/// Distance of the objects of two axes of a CiA 402 device.
export const kAxisOffset = 0x800;

export function axisIndex(base: number, axis: number): string {
  return (base + axis * kAxisOffset).toString(16).toUpperCase().padStart(4, "0");
}

export function axisNumber(name: string): number {
  return Number(/(\d+)$/.exec(name)?.[1] ?? 0);
}
