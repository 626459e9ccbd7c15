// What the oscilloscope is set to, as a file.
import { t } from "../../language";
import { type WindowName, kWindows } from "./fft";
import { kSeverities, type TriggerSettings } from "./trigger";

export interface ChannelSetup {
  /// Of a signal, or chosen for an expression.
  readonly name: string;
  /// Null: the channel is a signal of the rack.
  readonly expression: string | null;
  readonly unit: string;
  readonly visible: boolean;
  /// Drawn is value * gain + offset.
  readonly gain: number;
  readonly offset: number;
  /// The channel has a scale of its own instead of its unit's.
  readonly own: boolean;
}

export interface AxisSetup {
  /// A unit, or a channel's name with "=" before it if that has its own.
  readonly key: string;
  /// Null: sets itself.
  readonly range: { readonly from: number; readonly to: number } | null;
}

export interface SpectrumSetup {
  readonly shown: boolean;
  readonly window: WindowName;
  readonly decibels: boolean;
  readonly removeMean: boolean;
  readonly points: number;
}

export interface Setup {
  /// Sampling period, ns.
  readonly period: number;
  /// Shown time, ns.
  readonly span: number;
  /// Bytes of the record at most.
  readonly memory: number;
  readonly layout: "lanes" | "overlay";
  readonly channels: readonly ChannelSetup[];
  readonly axes: readonly AxisSetup[];
  readonly trigger: TriggerSettings;
  readonly spectrum: SpectrumSetup;
}

export const kShortestPeriod = 50_000;

export const kDefaultSetup: Setup = {
  period: 1_000_000,
  span: 5e9,
  memory: 64 * 2 ** 20,
  layout: "lanes",
  channels: [],
  axes: [],
  trigger: { mode: "auto", source: { kind: "none" }, before: 0.2, holdOff: 0 },
  spectrum: { shown: false, window: "hann", decibels: true, removeMean: true, points: 4096 },
};

const kForm = "stator-scope";
const kVersion = 1;

export function setupText(setup: Setup): string {
  return JSON.stringify({ form: kForm, version: kVersion, ...setup }, null, 2) + "\n";
}

export class SetupError extends Error {}

/// Reads values out of JSON and says where something is wrong.
class Reader {
  constructor(
    private readonly value: unknown,
    private readonly path: string,
  ) {}

  private fail(expected: string): never {
    throw new SetupError(
      t("{place} must be {expected}, not {value}", {
        place: this.path || t("the setup"),
        expected,
        value: this.value === undefined ? t("missing") : JSON.stringify(this.value),
      }),
    );
  }
  at(key: string): Reader {
    if (typeof this.value !== "object" || this.value === null || Array.isArray(this.value)) {
      this.fail(t("an object"));
    }
    return new Reader((this.value as Record<string, unknown>)[key], this.path === "" ? key : `${this.path}.${key}`);
  }
  get isNull(): boolean {
    return this.value === null;
  }
  number(low: number, high: number): number {
    if (typeof this.value !== "number" || !(this.value >= low && this.value <= high)) {
      this.fail(Number.isFinite(low) || Number.isFinite(high) ? t("a number from {low} to {high}", { low, high }) : t("a number"));
    }
    return this.value;
  }
  integer(low: number, high: number): number {
    const value = this.number(low, high);
    return Number.isInteger(value) ? value : this.fail(t("an integer"));
  }
  text(): string {
    return typeof this.value === "string" ? this.value : this.fail(t("a text"));
  }
  flag(): boolean {
    return typeof this.value === "boolean" ? this.value : this.fail(t("true or false"));
  }
  oneOf<T extends string>(choices: readonly T[]): T {
    return choices.includes(this.value as T) ? (this.value as T) : this.fail(t("one of {choices}", { choices: choices.join(", ") }));
  }
  list<T>(read: (reader: Reader) => T): T[] {
    if (!Array.isArray(this.value)) {
      this.fail(t("a list"));
    }
    return (this.value as unknown[]).map((each, i) => read(new Reader(each, `${this.path}[${i}]`)));
  }
  orNull<T>(read: (reader: Reader) => T): T | null {
    return this.isNull ? null : read(this);
  }
}

const kAny = [-Infinity, Infinity] as const;
const kHour = 3600e9;

function readChannel(reader: Reader): ChannelSetup {
  return {
    name: reader.at("name").text(),
    expression: reader.at("expression").orNull((each) => each.text()),
    unit: reader.at("unit").text(),
    visible: reader.at("visible").flag(),
    gain: reader.at("gain").number(...kAny),
    offset: reader.at("offset").number(...kAny),
    own: reader.at("own").flag(),
  };
}

function readTrigger(reader: Reader): TriggerSettings {
  const source = reader.at("source");
  const kind = source.at("kind").oneOf(["none", "level", "state", "event"]);
  return {
    mode: reader.at("mode").oneOf(["auto", "normal", "single"]),
    source:
      kind === "level"
        ? {
            kind,
            channel: source.at("channel").text(),
            level: source.at("level").number(...kAny),
            hysteresis: source.at("hysteresis").number(0, Infinity),
            edge: source.at("edge").oneOf(["rising", "falling", "either"]),
          }
        : kind === "state"
          ? {
              kind,
              channel: source.at("channel").text(),
              mask: source.at("mask").orNull((each) => each.integer(0, 0xffffffff)),
              value: source.at("value").orNull((each) => each.number(...kAny)),
            }
          : kind === "event"
            ? {
                kind,
                severity: source.at("severity").oneOf(kSeverities),
                device: source.at("device").text(),
                rule: source.at("rule").text(),
              }
            : { kind },
    before: reader.at("before").number(0, 1),
    holdOff: reader.at("holdOff").number(0, kHour),
  };
}

/// Throws SetupError, which says what is wrong and where.
export function parseSetup(text: string): Setup {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch (error) {
    throw new SetupError(t("this is no JSON: {problem}", { problem: (error as Error).message }));
  }
  const reader = new Reader(value, "");
  reader.at("form").oneOf([kForm]);
  reader.at("version").integer(kVersion, kVersion);
  const period = reader.at("period").integer(kShortestPeriod, 10e9);
  if (period % kShortestPeriod !== 0) {
    throw new SetupError(t("period must be a multiple of {shortest} ns, not {period}", { shortest: kShortestPeriod, period }));
  }
  const spectrum = reader.at("spectrum");
  const points = spectrum.at("points").integer(16, 1 << 20);
  if ((points & (points - 1)) !== 0) {
    throw new SetupError(t("spectrum.points must be a power of 2, not {points}", { points }));
  }
  return {
    period,
    span: reader.at("span").number(1e3, kHour),
    memory: reader.at("memory").integer(2 ** 20, 2 ** 30),
    layout: reader.at("layout").oneOf(["lanes", "overlay"]),
    channels: reader.at("channels").list(readChannel),
    axes: reader.at("axes").list((each) => ({
      key: each.at("key").text(),
      range: each.at("range").orNull((range) => ({ from: range.at("from").number(...kAny), to: range.at("to").number(...kAny) })),
    })),
    trigger: readTrigger(reader.at("trigger")),
    spectrum: {
      shown: spectrum.at("shown").flag(),
      window: spectrum.at("window").oneOf(Object.keys(kWindows) as WindowName[]),
      decibels: spectrum.at("decibels").flag(),
      removeMean: spectrum.at("removeMean").flag(),
      points,
    },
  };
}
