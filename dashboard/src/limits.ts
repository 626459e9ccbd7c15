// Where an axis of CiA 402 reaches a limit: from the objects that its drive has to the bars on which that is shown.

import type { Declaration, Object as DeviceObject } from "./api";
import { t } from "./language";

export interface Limit {
  /// For people, e.g. "at most (607Dh)".
  readonly name: string;
  /// In the unit of the signal.
  readonly value: number;
}

interface LimitObject {
  readonly index: number;
  /// How the name of the signal ends that it is a limit of.
  readonly signal: string;
  /// The limits that its entries are, by subindex.
  readonly limits: (entries: ReadonlyMap<number, number>) => Limit[];
}

/// A whole range of numbers is no limit.
const kUnlimited = 2 ** 31 - 1;

function limited(value: number | undefined): value is number {
  return value !== undefined && Math.abs(value) < kUnlimited;
}

function eitherWay(name: string): LimitObject["limits"] {
  return (entries) => {
    const value = entries.get(0);
    return limited(value) && value > 0
      ? [
          { name: t("{name}, negative", { name }), value: -value },
          { name: t("{name}, positive", { name }), value },
        ]
      : [];
  };
}

const kObjects: readonly LimitObject[] = [
  {
    index: 0x607d,
    signal: ".position_actual",
    limits: (entries) => {
      const [low, high] = [entries.get(1), entries.get(2)];
      if (low === high) {
        return [];
      }
      return [
        ...(limited(low) ? [{ name: t("at least (607Dh:01)"), value: low }] : []),
        ...(limited(high) ? [{ name: t("at most (607Dh:02)"), value: high }] : []),
      ];
    },
  },
  { index: 0x6065, signal: ".following_error", limits: eitherWay(t("window (6065h)")) },
  { index: 0x607f, signal: ".velocity_actual", limits: eitherWay(t("greatest of a profile (607Fh)")) },
  { index: 0x6080, signal: ".velocity_actual", limits: eitherWay(t("greatest of the motor (6080h)")) },
];

/// Indices of the objects of an axis that are limits of `signal`, of those that the device has; `at` gives an axis's index.
export function limitObjects(signal: string, declared: readonly Declaration[], at: (index: number) => string): string[] {
  return kObjects
    .filter((object) => signal.endsWith(object.signal))
    .map((object) => at(object.index))
    .filter((index) => declared.some((entry) => entry.index.toUpperCase() === index));
}

/// The limits of `signal` that objects of an axis are, as they were read.
export function limitsOf(signal: string, read: readonly DeviceObject[], at: (index: number) => string): Limit[] {
  return kObjects.flatMap((object) => {
    const entries = read.flatMap((each) => each.entries).filter((entry) => entry.index.toUpperCase() === at(object.index));
    if (!signal.endsWith(object.signal) || entries.length === 0) {
      return [];
    }
    return object.limits(
      new Map(entries.flatMap(({ subindex, value }) => (typeof value === "number" ? [[Number.parseInt(subindex, 16), value]] : []))),
    );
  });
}
