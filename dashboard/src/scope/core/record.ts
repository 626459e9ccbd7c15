// The record: ring, derived channels, gaps. Fed with batches, knows nothing of page or network.
import { type ChannelSetup } from "./setup";
import { DerivedChannel } from "./derived";
import { parseExpression } from "./expression";
import { SampleRing } from "./ring";

/// A stretch without samples between two neighbouring rows.
export interface Gap {
  readonly from: number;
  readonly to: number;
}

export interface Batch {
  readonly rows: number;
  readonly times: Float64Array;
  readonly columns: readonly Float64Array[];
}

const kMostRows = 1 << 24;
const kMostGaps = 1000;

/// Columns of the ring are the channels in the order of the setup.
export class ScopeRecord {
  ring: SampleRing;
  gaps: Gap[] = [];
  /// Rows that came, and that should have come between the first and the last of each run.
  received = 0;
  expected = 0;
  private channels: readonly ChannelSetup[] = [];
  private derived: (DerivedChannel | null)[] = [];
  private sources: number[] = [];
  private stream: readonly string[] = [];
  private interrupted = true;

  constructor(
    private memory: number,
    private period: number,
  ) {
    this.ring = new SampleRing(0, this.rows(0));
  }

  get missing(): number {
    return this.expected - this.received;
  }

  private rows(columns: number): number {
    return Math.min(kMostRows, SampleRing.rowsWithin(this.memory, columns));
  }

  /// How much time fits, ns.
  get depth(): number {
    return this.ring.capacity * this.period;
  }

  /// Channels, period or memory have changed. What is recorded stays, except when the period changes.
  configure(channels: readonly ChannelSetup[], period: number, memory: number): void {
    const sameRow = period === this.period;
    const before = this.channels;
    const identity = (channel: ChannelSetup) => JSON.stringify([channel.name, channel.expression]);
    const identities = before.map(identity);
    const sources = channels.map((channel) => identities.indexOf(identity(channel)));
    const same = sameRow && memory === this.memory && channels.length === before.length && sources.every((source, i) => source === i);
    this.channels = channels;
    if (same) {
      return;
    }
    this.period = period;
    this.memory = memory;
    this.ring = sameRow
      ? this.ring.rearranged(sources, this.rows(channels.length))
      : new SampleRing(channels.length, this.rows(channels.length));
    if (!sameRow) {
      this.gaps = [];
    }
    this.derive();
    this.connect();
  }

  /// Expressions that are new, or whose operands may have moved, are calculated for all that is
  /// recorded.
  private derive(): void {
    const columnOf = (end: number) => (name: string) => this.channels.findIndex((each, i) => i < end && each.name === name);
    this.derived = this.channels.map((channel, i) =>
      channel.expression === null ? null : new DerivedChannel(parseExpression(channel.expression), columnOf(i), this.period),
    );
    const kAtOnce = 4096;
    const { ring } = this;
    for (let row = ring.first; row < ring.end; row += kAtOnce) {
      const count = Math.min(kAtOnce, ring.end - row);
      const times = Float64Array.from({ length: count }, (_, i) => ring.time(row + i));
      const inputs: Float64Array[] = [];
      this.derived.forEach((derived, column) => {
        if (derived === null) {
          inputs.push(Float64Array.from({ length: count }, (_, i) => ring.value(column, row + i)));
        } else {
          const values = derived.push(times, inputs, count);
          inputs.push(values);
          ring.overwrite(column, row, values);
        }
      });
    }
  }

  /// The stream sends these signals from now on.
  subscribed(names: readonly string[]): void {
    this.stream = names;
    this.interrupted = true;
    this.connect();
  }

  private connect(): void {
    this.sources = this.channels.map((channel) => (channel.expression === null ? this.stream.indexOf(channel.name) : -1));
  }

  /// The next gap is wanted: nothing was lost in it.
  interrupt(): void {
    this.interrupted = true;
  }

  clear(): void {
    this.ring = new SampleRing(this.channels.length, this.rows(this.channels.length));
    this.gaps = [];
    this.interrupted = true;
    this.derive();
  }

  /// Number of the first new row.
  append(batch: Batch): number {
    if (batch.rows === 0) {
      return this.ring.end;
    }
    if (batch.times[0]! <= this.ring.newest) {
      this.clear(); // the rack was started anew, or put back
    }
    this.watch(batch);
    const inputs: (Float64Array | null)[] = [];
    this.derived.forEach((derived, column) => {
      inputs.push(derived === null ? (batch.columns[this.sources[column]!] ?? null) : derived.push(batch.times, inputs, batch.rows));
    });
    this.ring.append(batch.times, inputs, batch.rows);
    while (this.gaps.length > 0 && this.gaps[0]!.to <= this.ring.oldest) {
      this.gaps.shift();
    }
    return Math.max(this.ring.first, this.ring.end - batch.rows);
  }

  private watch(batch: Batch): void {
    let before = this.ring.newest;
    for (let row = 0; row < batch.rows; ++row) {
      const time = batch.times[row]!;
      const steps = this.interrupted ? 1 : Math.round((time - before) / this.period);
      if (time - before > 1.5 * this.period && this.gaps.length < kMostGaps) {
        this.gaps.push({ from: before, to: time });
      }
      this.expected += Number.isNaN(steps) ? 1 : steps;
      this.interrupted = false;
      before = time;
    }
    this.received += batch.rows;
  }
}
