// From a fault's declaration to the fields of a form, and from these to the request.

import type { FaultKind, FaultParameter, Wiring } from "./api";

export type Field = "number" | "text" | "switch";

export function fieldOf(parameter: FaultParameter): Field {
  const type = parameter.type.toLowerCase();
  if (type.startsWith("bool")) {
    return "switch";
  }
  return /^(int|uint|integer|unsigned|number|float|double|real)/.test(type) ? "number" : "text";
}

export function defaultsOf(kind: FaultKind): Record<string, string> {
  const values: Record<string, string> = {};
  for (const parameter of kind.parameters) {
    const { default: value } = parameter;
    values[parameter.name] = value === null || value === undefined ? "" : String(value);
  }
  return values;
}

/// What is wrong with a value; empty: nothing.
export function fieldProblem(parameter: FaultParameter, text: string): string {
  if (fieldOf(parameter) !== "number" || text.trim() === "") {
    return "";
  }
  const value = Number(text);
  if (!Number.isFinite(value)) {
    return "a number is needed";
  }
  if (parameter.minimum !== null && parameter.minimum !== undefined && value < parameter.minimum) {
    return `at least ${parameter.minimum}`;
  }
  if (parameter.maximum !== null && parameter.maximum !== undefined && value > parameter.maximum) {
    return `at most ${parameter.maximum}`;
  }
  return "";
}

/// The body of the request, with the keys of an [[event]] table of a rack file. Empty fields are left out.
export function faultRequest(kind: FaultKind, target: Readonly<Record<string, unknown>>, values: Readonly<Record<string, string>>): Record<string, unknown> {
  const body: Record<string, unknown> = { action: kind.name, ...target };
  for (const parameter of kind.parameters) {
    const text = (values[parameter.name] ?? "").trim();
    if (text === "") {
      continue;
    }
    const field = fieldOf(parameter);
    body[parameter.name] = field === "number" ? Number(text) : field === "switch" ? text === "true" : text;
  }
  return body;
}

export interface Target {
  readonly label: string;
  readonly keys: Readonly<Record<string, unknown>>;
}

/// What a fault of a kind can be put on.
export function targetsOf(
  appliesTo: string,
  rack: { devices: readonly string[]; axes: readonly { device: string; axis: string }[]; wiring: Wiring | null; networks: readonly { name: string; kind: string }[] },
): Target[] {
  switch (appliesTo) {
    case "port":
      return (rack.wiring?.segments ?? []).flatMap((segment) =>
        segment.devices.flatMap((device) =>
          device.ports.map((port) => ({
            label: `${device.name}, port ${port.number}${port.neighbour ? ` (to ${port.neighbour})` : ""}`,
            keys: { device: device.name, port: port.number },
          })),
        ),
      );
    case "axis":
      return rack.axes.map(({ device, axis }) => ({
        label: `${device}, ${axis}`,
        keys: { device, axis: Number(/\d+$/.exec(axis)?.[0] ?? 0) },
      }));
    case "bus":
      return rack.networks.filter(({ kind }) => kind === "can").map(({ name }) => ({ label: name, keys: { bus: name } }));
    case "line":
      return rack.networks.filter(({ kind }) => kind === "serial").map(({ name }) => ({ label: name, keys: { line: name } }));
    default:
      return rack.devices.map((device) => ({ label: device, keys: { device } }));
  }
}
