// Triggers: when something happened, and which stretch of time is shown because of it.
import type { Event } from "../../api_types";

export type Edge = "rising" | "falling" | "either";
export type TriggerMode = "auto" | "normal" | "single";

export type TriggerSource =
  | { readonly kind: "none" }
  | {
      readonly kind: "level";
      readonly channel: string;
      readonly level: number;
      /// How far the signal must have been on the other side of the level, in its unit, >= 0.
      readonly hysteresis: number;
      readonly edge: Edge;
    }
  | {
      readonly kind: "state";
      readonly channel: string;
      /// Bits that count, null: all of the value.
      readonly mask: number | null;
      /// The state to come into, null: any change.
      readonly value: number | null;
    }
  | {
      readonly kind: "event";
      /// This severity or a worse one.
      readonly severity: Event["severity"];
      /// Empty: of any device, by any rule.
      readonly device: string;
      readonly rule: string;
    };

export interface TriggerSettings {
  readonly mode: TriggerMode;
  readonly source: TriggerSource;
  /// Share of the shown time that lies before the trigger, 0..1.
  readonly before: number;
  /// Least time from one trigger to the next, ns.
  readonly holdOff: number;
}

/// Looks at one channel row by row.
export interface Detector {
  /// The time of the trigger, NaN if there was none between the row before and this one.
  feed(time: number, value: number): number;
}

class LevelDetector implements Detector {
  private below = false; // has been under level - hysteresis
  private above = false;
  private lastTime = NaN;
  private lastValue = NaN;

  constructor(
    private readonly level: number,
    private readonly hysteresis: number,
    private readonly edge: Edge,
  ) {}

  feed(time: number, value: number): number {
    let found = NaN;
    if (this.below && value >= this.level) {
      this.below = false;
      found = this.edge === "falling" ? NaN : this.crossing(time, value);
    } else if (this.above && value <= this.level) {
      this.above = false;
      found = this.edge === "rising" ? NaN : this.crossing(time, value);
    }
    // Strictly beyond, so that a signal that rests at the level does not trigger without hysteresis.
    if (value < this.level && value <= this.level - this.hysteresis) {
      this.below = true;
    }
    if (value > this.level && value >= this.level + this.hysteresis) {
      this.above = true;
    }
    this.lastTime = time;
    this.lastValue = value;
    return found;
  }

  /// Between the two samples, as if the signal went straight.
  private crossing(time: number, value: number): number {
    const share = (this.level - this.lastValue) / (value - this.lastValue);
    return share >= 0 && share < 1 ? this.lastTime + share * (time - this.lastTime) : time;
  }
}

class StateDetector implements Detector {
  private last = NaN;

  constructor(
    private readonly mask: number | null,
    private readonly value: number | null,
  ) {}

  feed(time: number, value: number): number {
    const state = this.mask === null ? value : Number(BigInt.asUintN(32, BigInt(Math.trunc(value || 0))) & BigInt(this.mask));
    const changed = !Number.isNaN(this.last) && state !== this.last;
    this.last = state;
    return changed && (this.value === null || state === this.value) ? time : NaN;
  }
}

/// Null: the source looks at no channel.
export function makeDetector(source: TriggerSource): Detector | null {
  switch (source.kind) {
    case "level":
      return new LevelDetector(source.level, source.hysteresis, source.edge);
    case "state":
      return new StateDetector(source.mask, source.value);
    default:
      return null;
  }
}

/// From the least to the worst.
export const kSeverities: readonly Event["severity"][] = ["information", "refusal", "warning", "fault"];

/// Whether an event is one that triggers.
export function eventTriggers(
  source: TriggerSource,
  event: { readonly device: string; readonly rule: string; readonly severity: Event["severity"] },
): boolean {
  return (
    source.kind === "event" &&
    kSeverities.indexOf(event.severity) >= kSeverities.indexOf(source.severity) &&
    (source.device === "" || source.device === event.device) &&
    (source.rule === "" || source.rule === event.rule)
  );
}

/// A stretch of time to be shown. `trigger` is NaN if it is only the newest.
export interface Frame {
  readonly start: number;
  readonly end: number;
  readonly trigger: number;
}

export type AcquisitionState = "waiting" | "triggered" | "rolling" | "done";

/// From triggers to frames. Times are those of the samples, so a slow page changes nothing.
export class Acquisition {
  /// The newest complete frame.
  frame: Frame | null = null;
  /// How many frames were completed.
  count = 0;
  private pending = NaN;
  private holdUntil = -Infinity;
  private quietSince = NaN;
  private now = NaN;
  private finished = false;

  /// `span` in ns.
  constructor(
    private settings: TriggerSettings,
    private span: number,
  ) {}

  get state(): AcquisitionState {
    if (this.finished) {
      return "done";
    }
    if (this.settings.source.kind === "none") {
      return "rolling";
    }
    if (!Number.isNaN(this.pending)) {
      return "triggered";
    }
    return this.settings.mode === "auto" && this.quiet ? "rolling" : "waiting";
  }

  /// In mode auto: there was no trigger for so long that the newest samples are shown instead.
  private get quiet(): boolean {
    const kPatience = 100e6;
    return this.now - this.quietSince > Math.max(kPatience, 2 * this.span);
  }

  setSpan(span: number): void {
    this.span = span;
  }

  /// Something happened at `time`. Not taken while a frame is being filled, or in the hold-off.
  offer(time: number): boolean {
    if (this.finished || !Number.isNaN(this.pending) || time < this.holdUntil) {
      return false;
    }
    this.pending = time;
    return true;
  }

  /// There are samples up to `time`.
  advance(time: number): void {
    this.now = time;
    if (Number.isNaN(this.quietSince)) {
      this.quietSince = time;
    }
    const start = this.pending - this.settings.before * this.span;
    if (time >= start + this.span) {
      this.frame = { start, end: start + this.span, trigger: this.pending };
      ++this.count;
      this.holdUntil = Math.max(this.pending + this.settings.holdOff, start + this.span);
      this.quietSince = time;
      this.pending = NaN;
      this.finished = this.settings.mode === "single";
    }
  }

  /// What is to be shown, `newest` being the time of the last sample: the newest samples when no
  /// trigger is wanted or mode auto got none, else the last complete frame.
  shown(newest: number): Frame | null {
    if (this.state === "rolling" || (this.settings.mode === "auto" && this.frame === null)) {
      return { start: newest - this.span, end: newest, trigger: NaN };
    }
    return this.frame;
  }
}
