// Frames as they come, those that repeat counted together: cyclic process data would hide everything else.
import type { Frame } from "./api_types";

/// Frames of which only data differ.
export interface Repeating {
  readonly key: string;
  /// Frames of this kind since the log began.
  readonly count: number;
  /// Frames per second of simulated time, over the last second or so; NaN: nobody knows yet.
  readonly rate: number;
  readonly last: Frame;
  /// The newest, the newest first.
  readonly recent: readonly Frame[];
}

export interface LogLimits {
  /// Frames that are kept as a list.
  readonly frames: number;
  /// Of each kind.
  readonly recent: number;
  /// Kinds of which one or two have come.
  readonly kinds: number;
}

const kLimits: LogLimits = { frames: 5000, recent: 20, kinds: 2000 };

/// So many frames of one kind are shown as one row.
export const kRepeats = 3;

/// What a CAN frame is called that comes again and again.
const kCyclicCan = /^[0-9A-F]+h (PDO|SYNC|TIME|heartbeat)\b/;
const kDatagram = /^datagram \d+$/;

/// Frames with the same key are of one kind; null: a frame that stands for itself. An EtherCAT frame's kind is what its datagrams
/// do, where, with which working counter, and what registers of the state machine say; one with a mailbox message stands for itself.
export function kindOf(frame: Frame): string | null {
  let datagrams = "";
  for (const [name, value] of frame.fields) {
    if (name === "mailbox") {
      return null;
    }
    if (kDatagram.test(name)) {
      datagrams += `; ${value}`;
    }
  }
  const cyclic = datagrams !== "" || kCyclicCan.test(frame.summary);
  return cyclic ? `${frame.network} ${frame.direction} ${datagrams === "" ? frame.summary : datagrams.slice(2)}` : null;
}

/// What process data and PDOs hold: all fields that do not say how the frame is made.
export function valuesOf(frame: Frame): readonly (readonly [string, string])[] {
  return frame.fields.filter(([name]) => !kDatagram.test(name) && !["identifier", "length", "remote"].includes(name));
}

class Kind implements Repeating {
  count = 0;
  rate = NaN;
  recent: Frame[] = [];
  private since = 0;
  private counted = 0;

  constructor(
    readonly key: string,
    private readonly most: number,
  ) {}

  get last(): Frame {
    return this.recent[0]!;
  }

  take(frame: Frame): void {
    const kWindow = 1e9;
    if (this.count === 0 || frame.time_ns < this.last.time_ns) {
      this.since = frame.time_ns;
      this.counted = 0;
    } else {
      this.counted += 1;
    }
    const passed = frame.time_ns - this.since;
    if (passed > 0 && (passed >= kWindow || Number.isNaN(this.rate) || this.count < this.most)) {
      this.rate = (this.counted * 1e9) / passed;
    }
    if (passed >= kWindow) {
      this.since = frame.time_ns;
      this.counted = 0;
    }
    this.count += 1;
    this.recent = [frame, ...this.recent.slice(0, this.most - 1)];
  }
}

/// Each frame is counted once: in `repeating`, or among those that stand for themselves.
export class TrafficLog {
  /// Frames that came.
  received = 0;
  /// Of these, those that stand for themselves.
  single = 0;
  /// The newest frame's time.
  newest = 0;
  private readonly kinds = new Map<string, Kind>();
  private all: Frame[] = [];
  private singles: Frame[] = [];

  constructor(private readonly limits: LogLimits = kLimits) {}

  take(frames: readonly Frame[]): void {
    for (const frame of frames) {
      this.received += 1;
      this.newest = frame.time_ns;
      this.all.push(frame);
      const key = kindOf(frame);
      const kind = key === null ? null : this.kind(key);
      kind?.take(frame);
      if (kind === null || kind.count < kRepeats) {
        this.singles.push(frame);
        this.single += 1;
      } else if (kind.count === kRepeats) {
        const before = new Set(kind.recent);
        this.singles = this.singles.filter((each) => !before.has(each));
        this.single -= kRepeats - 1;
      }
    }
    // Seldom, since it moves all.
    if (this.all.length > 2 * this.limits.frames) {
      this.all = this.all.slice(-this.limits.frames);
    }
    if (this.singles.length > 2 * this.limits.frames) {
      this.singles = this.singles.slice(-this.limits.frames);
    }
  }

  private kind(key: string): Kind {
    let kind = this.kinds.get(key);
    if (kind === undefined) {
      kind = new Kind(key, Math.max(this.limits.recent, kRepeats));
      this.kinds.set(key, kind);
      if (this.kinds.size > this.limits.kinds) {
        this.forget();
      }
    }
    return kind;
  }

  /// Kinds of which few have come go; their frames stay what they are, ones that stand for themselves.
  private forget(): void {
    let goes = this.kinds.size / 2;
    for (const [key, { count }] of this.kinds) {
      if (count < kRepeats && count > 0 && --goes >= 0) {
        this.kinds.delete(key);
      }
    }
  }

  /// In the order in which they came first.
  get repeating(): Repeating[] {
    return [...this.kinds.values()].filter(({ count }) => count >= kRepeats);
  }

  /// The newest `most` that `fits` takes, the newest first: of all frames, or of those that stand for themselves.
  newestOf(which: "all" | "single", most: number, fits: (frame: Frame) => boolean): Frame[] {
    const from = which === "all" ? this.all : this.singles;
    const found: Frame[] = [];
    for (let i = from.length - 1; i >= 0 && found.length < most; --i) {
      if (fits(from[i]!)) {
        found.push(from[i]!);
      }
    }
    return found;
  }
}
