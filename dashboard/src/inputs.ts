// How an input of a device is set: as a switch, one of a few numbers, or a slider.

import type { Input } from "./api";
import { t } from "./language";

export type Control =
  | { readonly kind: "switch" }
  | { readonly kind: "choice"; readonly values: readonly number[] }
  | { readonly kind: "slider"; readonly minimum: number; readonly maximum: number; readonly step: number };

const kLongestChoice = 5;

export function controlOf(input: Input, span: number): Control {
  const minimum = input.minimum ?? -span;
  const maximum = input.maximum ?? span;
  const whole = Number.isInteger(minimum) && Number.isInteger(maximum);
  if (input.unit === "" && minimum === 0 && maximum === 1) {
    return { kind: "switch" };
  }
  if (input.unit === "" && whole && maximum - minimum < kLongestChoice) {
    return { kind: "choice", values: Array.from({ length: maximum - minimum + 1 }, (_, i) => minimum + i) };
  }
  const low = Math.max(minimum, minimum < 0 ? -span : minimum);
  const high = Math.min(maximum, span);
  return { kind: "slider", minimum: low, maximum: high, step: input.unit === "count" ? 1 : niceStep(high - low) };
}

/// About 500 steps, in steps of 1, 2 or 5.
export function niceStep(range: number): number {
  const raw = range / 500;
  const power = 10 ** Math.floor(Math.log10(raw));
  const times = [1, 2, 5, 10].find((n) => n * power >= raw * 0.999) ?? 10;
  return Number((times * power).toPrecision(3));
}

/// Spans a slider can have below the range of the input: a torque may be up to 1000 N m, but a motor of
/// half a newton metre needs finer steps.
export function spansOf(input: Input): number[] {
  const top = Math.max(Math.abs(input.minimum ?? 1e6), Math.abs(input.maximum ?? 1e6));
  if (input.unit !== "Nm" || top <= 1) {
    return [top];
  }
  const spans: number[] = [];
  for (let span = 0.1; span < top * 1.001; span *= 10) {
    spans.push(Number(span.toPrecision(3)));
  }
  return spans;
}

export function firstSpan(input: Input): number {
  const spans = spansOf(input);
  return spans.includes(1) ? 1 : (spans[spans.length - 1] ?? 1);
}

/// Groups in the order in which they are shown, as people call them.
const kGroups: readonly (readonly [Input["group"], string])[] = [
  ["load", t("Load")],
  ["supply", t("Supply")],
  ["switches", t("Switches")],
  ["driver", t("Power stage and motor cables")],
  ["sensors", t("Sensors")],
  ["heat", t("Heat")],
  ["lines", t("Inputs and pins")],
  ["network", t("Network")],
  ["other", t("Other")],
];

export interface InputSection {
  readonly group: Input["group"];
  readonly title: string;
  readonly inputs: readonly Input[];
}

/// Inputs of the same group together; order within a group is kept.
export function sectionsOf(inputs: readonly Input[]): InputSection[] {
  return kGroups.flatMap(([group, title]) => {
    const own = inputs.filter((input) => input.group === group);
    return own.length === 0 ? [] : [{ group, title, inputs: own }];
  });
}

/// What an input belongs to: "axis0", a part of a board, "" for the device itself.
export function ownerOf(input: Input, device: string): string {
  const rest = input.name.slice(device.length + 1);
  const dot = rest.indexOf(".");
  return dot < 0 ? "" : rest.slice(0, dot);
}

/// Those of the devices that have a board with peripherals, which have inputs of their own.
export function boardsOf(inputs: readonly Input[], devices: readonly string[]): string[] {
  const isPeripheral = (owner: string) => owner !== "" && !/^axis\d+$/.test(owner);
  return devices.filter((device) => inputs.some((input) => input.name.startsWith(`${device}.`) && isPeripheral(ownerOf(input, device))));
}

/// Inputs by what they belong to. Order is kept.
export function byOwner(inputs: readonly Input[], device: string): Map<string, Input[]> {
  const owners = new Map<string, Input[]>();
  for (const input of inputs) {
    const owner = ownerOf(input, device);
    owners.set(owner, [...(owners.get(owner) ?? []), input]);
  }
  return owners;
}

/// Whether somebody, or a fault, has made an input other than it is by itself.
export function differs(input: Input): boolean {
  return input.value !== null && input.value !== input.normal;
}

/// Whether each word of `search` stands in an input's name or in that of its group.
export function matches(input: Input, search: string): boolean {
  const title = kGroups.find(([group]) => group === input.group)?.[1] ?? "";
  const text = `${input.name} ${input.name.replace(/[_.]/g, " ")} ${title}`.toLowerCase();
  return search
    .toLowerCase()
    .split(/\s+/)
    .every((word) => text.includes(word));
}

/// "left_switch_fault" as a person reads it.
export function labelOf(name: string): string {
  return name.replace(/[_.]/g, " ");
}
