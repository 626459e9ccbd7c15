// The oscilloscope's memory: the newest rows of all channels in typed arrays of fixed length.

/// Rows of one block, of which minimum and maximum are kept so that a long record is drawn without
/// looking at each of its samples.
const kBlock = 32;

/// A row is addressed by its number since the ring was made: `first` is the oldest that is kept,
/// `end` the one that comes next. Times are nanoseconds and grow from row to row.
export class SampleRing {
  readonly capacity: number;
  private readonly times: Float64Array;
  private readonly data: Float64Array[];
  private readonly low: Float64Array[];
  private readonly high: Float64Array[];
  private written = 0;

  /// `rows` is rounded up to whole blocks.
  constructor(
    readonly columns: number,
    rows: number,
  ) {
    this.capacity = Math.max(1, Math.ceil(rows / kBlock)) * kBlock;
    const make = (length: number) => Array.from({ length: columns }, () => new Float64Array(length));
    this.times = new Float64Array(this.capacity);
    this.data = make(this.capacity);
    this.low = make(this.capacity / kBlock);
    this.high = make(this.capacity / kBlock);
  }

  /// As many rows as fit into `bytes`.
  static rowsWithin(bytes: number, columns: number): number {
    return Math.max(kBlock, Math.floor(bytes / (8 * (1 + columns + (2 * columns) / kBlock)) / kBlock) * kBlock);
  }

  get bytes(): number {
    return 8 * (this.capacity * (1 + this.columns) + (2 * this.columns * this.capacity) / kBlock);
  }
  get first(): number {
    return Math.max(0, this.written - this.capacity);
  }
  get end(): number {
    return this.written;
  }
  get size(): number {
    return this.end - this.first;
  }
  /// Of the oldest and the newest row; NaN if there is none.
  get oldest(): number {
    return this.size === 0 ? NaN : this.time(this.first);
  }
  get newest(): number {
    return this.size === 0 ? NaN : this.time(this.end - 1);
  }

  time(row: number): number {
    return this.times[row % this.capacity]!;
  }
  value(column: number, row: number): number {
    return this.data[column]![row % this.capacity]!;
  }

  /// Adds `rows` rows; `columns` has one array per column, null where a column has no values (NaN).
  append(times: Float64Array, columns: readonly (Float64Array | null)[], rows: number): void {
    const from = Math.max(0, rows - this.capacity); // what would be overwritten at once
    this.written += from;
    for (let row = from; row < rows; ++row) {
      this.times[(this.written + row - from) % this.capacity] = times[row]!;
    }
    for (let column = 0; column < this.columns; ++column) {
      this.fill(column, columns[column] ?? null, from, rows);
    }
    this.written += rows - from;
  }

  private fill(column: number, values: Float64Array | null, from: number, rows: number): void {
    const data = this.data[column]!;
    const low = this.low[column]!;
    const high = this.high[column]!;
    let slot = this.written % this.capacity;
    for (let row = from; row < rows; ++row) {
      const value = values === null ? NaN : values[row]!;
      data[slot] = value;
      const block = Math.floor(slot / kBlock);
      if (slot % kBlock === 0) {
        low[block] = Infinity;
        high[block] = -Infinity;
      }
      if (value < low[block]!) {
        low[block] = value;
      }
      if (value > high[block]!) {
        high[block] = value;
      }
      slot = slot + 1 === this.capacity ? 0 : slot + 1;
    }
  }

  /// Writes `values` over the rows of `column` from row `from` on.
  overwrite(column: number, from: number, values: Float64Array): void {
    const data = this.data[column]!;
    for (let i = 0; i < values.length; ++i) {
      data[(from + i) % this.capacity] = values[i]!;
    }
    const last = from + values.length;
    for (let start = Math.floor(from / kBlock) * kBlock; start < last; start += kBlock) {
      let low = Infinity;
      let high = -Infinity;
      for (let row = Math.max(start, this.first); row < Math.min(start + kBlock, this.end); ++row) {
        const value = this.value(column, row);
        low = value < low ? value : low;
        high = value > high ? value : high;
      }
      const block = Math.floor((start % this.capacity) / kBlock);
      this.low[column]![block] = low;
      this.high[column]![block] = high;
    }
  }

  /// The first row at `time` or later, between `from` and end.
  lowerBound(time: number, from = this.first): number {
    let low = from;
    let high = this.end;
    while (low < high) {
      const middle = Math.floor((low + high) / 2);
      if (this.time(middle) < time) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  }

  /// The row whose time is nearest; -1 if there is none.
  nearest(time: number): number {
    if (this.size === 0) {
      return -1;
    }
    const after = this.lowerBound(time);
    if (after === this.first) {
      return after;
    }
    return after < this.end && this.time(after) - time < time - this.time(after - 1) ? after : after - 1;
  }

  /// Smallest and largest value of the rows from <= row < to, which must be kept; Infinity and
  /// -Infinity if all are NaN. Looks at each row only at the ends of the range.
  extremes(column: number, from: number, to: number, result: { low: number; high: number }): void {
    const data = this.data[column]!;
    const lows = this.low[column]!;
    const highs = this.high[column]!;
    let low = Infinity;
    let high = -Infinity;
    let slot = from % this.capacity;
    for (let left = to - from; left > 0; ) {
      if (slot % kBlock === 0 && left >= kBlock) {
        const block = slot / kBlock;
        low = lows[block]! < low ? lows[block]! : low;
        high = highs[block]! > high ? highs[block]! : high;
        slot += kBlock;
        left -= kBlock;
      } else {
        const count = Math.min(left, kBlock - (slot % kBlock)); // the ring ends with a block
        for (const end = slot + count; slot < end; ++slot) {
          const value = data[slot]!;
          low = value < low ? value : low;
          high = value > high ? value : high;
        }
        left -= count;
      }
      slot = slot === this.capacity ? 0 : slot;
    }
    result.low = low;
    result.high = high;
  }

  /// A ring of `rows` rows with the newest rows of this one. `sources` says for each of its columns
  /// which of this ring's it continues, -1 for a new one.
  rearranged(sources: readonly number[], rows: number): SampleRing {
    const ring = new SampleRing(sources.length, rows);
    const kAtOnce = 4096;
    const times = new Float64Array(kAtOnce);
    const parts = sources.map((source) => (source < 0 ? null : new Float64Array(kAtOnce)));
    for (let row = Math.max(this.first, this.end - ring.capacity); row < this.end; ) {
      const count = Math.min(kAtOnce, this.end - row);
      for (let i = 0; i < count; ++i) {
        times[i] = this.time(row + i);
        parts.forEach((part, column) => {
          if (part !== null) {
            part[i] = this.value(sources[column]!, row + i);
          }
        });
      }
      ring.append(times, parts, count);
      row += count;
    }
    return ring;
  }
}
