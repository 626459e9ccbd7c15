// From a fault's declaration to the fields of a form, and from these to the request.

import type { FaultKind, FaultParameter, Input, Wiring } from "./api";
import { ownerOf } from "./inputs";
import { t } from "./language";
import { parseInteger } from "./object_search";

export type Field = "whole" | "number" | "text" | "choice";
export type Values = Readonly<Record<string, string>>;

export function fieldOf({ type }: FaultParameter): Field {
  return type === "integer" ? "whole" : type === "duration" ? "text" : type;
}

/// Of parameters that are needed: a value with which a fault shows and most drives live, to begin with.
const kFirstValues: Readonly<Record<string, string>> = {
  slip: "0.1",
  delay: "5ms",
  kelvin: "40",
  volts: "5",
  ohms: "1",
  ppb: "10000",
  counts: "50",
};

export function defaultsOf(parameters: readonly FaultParameter[]): Record<string, string> {
  return Object.fromEntries(
    parameters.map((parameter) => [
      parameter.name,
      parameter.default === "" && parameter.needed ? (kFirstValues[parameter.name] ?? "") : parameter.default,
    ]),
  );
}

function numberOf(field: Field, text: string): number | null {
  const whole = parseInteger(text);
  if (whole !== null) {
    return Number(whole);
  }
  return field === "number" && Number.isFinite(Number(text)) ? Number(text) : null;
}

/// What is wrong with a value; empty: nothing.
export function fieldProblem(parameter: FaultParameter, text: string): string {
  const field = fieldOf(parameter);
  if (text.trim() === "") {
    return parameter.needed ? t("needed") : "";
  }
  if (field !== "number" && field !== "whole") {
    return "";
  }
  const value = numberOf(field, text);
  if (value === null) {
    return field === "whole" ? t("a whole number is needed") : t("a number is needed");
  }
  if (parameter.minimum !== null && value < parameter.minimum) {
    return t("at least {least}", { least: parameter.minimum });
  }
  if (parameter.maximum !== null && value > parameter.maximum) {
    return t("at most {most}", { most: parameter.maximum });
  }
  return "";
}

/// The keys that differ from what is the case without them.
export function filledIn(parameters: readonly FaultParameter[], values: Values): Record<string, unknown> {
  const keys: Record<string, unknown> = {};
  for (const parameter of parameters) {
    const text = (values[parameter.name] ?? "").trim();
    if (text === "" || text === parameter.default) {
      continue;
    }
    const field = fieldOf(parameter);
    keys[parameter.name] = field === "number" || field === "whole" ? numberOf(field, text) : text;
  }
  return keys;
}

/// The body of the request: the keys of a [[fault]] of a rack file.
export function faultRequest(
  kind: FaultKind,
  target: TargetKeys,
  keys: Readonly<Record<string, unknown>>,
  when: Readonly<Record<string, unknown>>,
): Record<string, unknown> {
  const body: Record<string, unknown> = { kind: kind.name, ...target, ...keys };
  if (Object.keys(when).length > 0) {
    body["when"] = when;
  }
  return body;
}

/// A range worth telling: bounds that only keep numbers sane are not.
export function rangeText(parameter: FaultParameter): string {
  const field = fieldOf(parameter);
  const { minimum, maximum } = parameter;
  if ((field !== "number" && field !== "whole") || (minimum === null && maximum === null)) {
    return "";
  }
  const bound = (value: number | null, sign: string) => (value === null || Math.abs(value) >= 1e9 ? `${sign}∞` : String(value));
  return `${bound(minimum, "−")} … ${bound(maximum, "")}`;
}

/// Keys of a [[fault]] that say where it is put.
export type TargetKeys = Readonly<Record<string, unknown>>;

export interface Target {
  readonly label: string;
  readonly keys: TargetKeys;
}

/// The first of them that has all keys of `at`; −1 if none has, so that no other one is hit by mistake.
export function targetAt(targets: readonly Target[], at: TargetKeys): number {
  return targets.findIndex(({ keys }) => Object.entries(at).every(([name, value]) => keys[name] === value));
}

/// Whether a kind can hit anything at a network; those of a network say so in their names.
export function fitsNetwork(kind: string, network: string): boolean {
  const own = /^(ethercat|can|serial)-/.exec(kind)?.[1];
  return own === undefined || own === network;
}

/// Faults of what an input stands for: where they are put, and the kinds with the values that are meant.
export interface FaultsOfInput {
  readonly at: TargetKeys;
  readonly kinds: ReadonlyMap<string, Values>;
}

/// The faults that set an input, else those that set the same thing's other inputs ("left_switch_fault" of "left_switch"), else,
/// of what is measured in a unit, those that set others of its group, as the temperature of a power stage has to do with heat.
/// `inputs` are those of the device.
export function faultsOfInput(input: Input, device: string, inputs: readonly Input[], kinds: readonly FaultKind[]): FaultsOfInput | null {
  const owner = ownerOf(input, device);
  const axis = /^axis(\d+)$/.exec(owner)?.[1];
  const peripheral = owner !== "" && axis === undefined; // of a board
  const prefix = owner === "" ? `${device}.` : `${device}.${owner}.`;
  const name = input.name.slice(prefix.length);
  const beside = new Map(inputs.filter((each) => ownerOf(each, device) === owner).map((each) => [each.name.slice(prefix.length), each]));
  const reaching = (meant: (reached: string) => boolean) =>
    new Map(
      kinds
        .filter((kind) => kind.applies_to === (owner === "" ? "device" : "axis"))
        .flatMap((kind): [string, Values][] => {
          const reached = kind.inputs.find((each) => each.of_peripheral === peripheral && beside.has(each.name) && meant(each.name));
          const keys: Readonly<Record<string, number | string>> = { ...reached?.keys, ...(peripheral ? { peripheral: owner } : {}) };
          return reached ? [[kind.name, Object.fromEntries(Object.entries(keys).map(([key, value]) => [key, String(value)]))]] : [];
        }),
    );
  const found = [
    reaching((reached) => reached === name),
    reaching((reached) => reached.startsWith(`${name}_`)),
    reaching((reached) => input.unit !== "" && beside.get(reached)?.group === input.group),
  ].find((each) => each.size > 0);
  return found ? { at: { device, ...(axis === undefined ? {} : { axis: Number(axis) }) }, kinds: found } : null;
}

/// What a fault of a kind can be put on.
export function targetsOf(
  appliesTo: string,
  rack: {
    devices: readonly string[];
    axes: readonly { device: string; axis: string }[];
    /// Devices with peripherals on a board, which take faults of axes.
    boards: readonly string[];
    wiring: Wiring | null;
    networks: readonly { name: string; kind: string }[];
  },
): Target[] {
  switch (appliesTo) {
    case "port": {
      const slaves = (rack.wiring?.segments ?? []).flatMap((segment) => segment.devices);
      const nodes = (rack.wiring?.buses ?? []).flatMap((bus) => bus.devices.map((device) => ({ device, bus: bus.name })));
      return [
        ...slaves.flatMap((device) =>
          device.ports.map((port) => ({
            label: port.neighbour
              ? t("{device}, port {port} (to {neighbour})", { device: device.name, port: port.number, neighbour: port.neighbour })
              : t("{device}, port {port}", { device: device.name, port: port.number }),
            keys: { device: device.name, port: port.number },
          })),
        ),
        ...nodes.map(({ device, bus }) => ({ label: t("{device} (at {bus})", { device, bus }), keys: { device } })),
      ];
    }
    case "axis":
      return [
        ...rack.axes
          .filter(({ axis }) => /\d$/.test(axis))
          .map(({ device, axis }) => ({
            label: `${device}, ${axis}`,
            keys: { device, axis: Number(/\d+$/.exec(axis)?.[0] ?? 0) },
          })),
        ...rack.boards.map((device) => ({ label: t("{device}, a part on its board", { device }), keys: { device } })),
      ];
    case "bus":
      return [
        ...rack.networks
          .filter(({ kind }) => kind === "can")
          .map(({ name }) => ({ label: t("{bus}: all frames", { bus: name }), keys: { bus: name } })),
        ...(rack.wiring?.buses ?? []).flatMap((bus) =>
          bus.devices.map((device) => ({ label: t("{bus}: what {device} sends", { bus: bus.name, device }), keys: { device } })),
        ),
      ];
    case "line":
      return rack.networks.filter(({ kind }) => kind === "serial").map(({ name }) => ({ label: name, keys: { line: name } }));
    default:
      return rack.devices.map((device) => ({ label: device, keys: { device } }));
  }
}
