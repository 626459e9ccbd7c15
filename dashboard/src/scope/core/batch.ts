// The binary message of samples (src/stator/web/stream/sample_batch.hpp), all of it little-endian.

export const kBatchMagic = 0x31425353; // "SSB1"
const kHeader = 24;

export interface SampleBatch {
  readonly rows: number;
  /// Rows dropped by the server since the stream began.
  readonly dropped: number;
  /// Sampling instants, nanoseconds of simulated time. A double holds them exactly for 104 days.
  readonly times: Float64Array;
  /// One array for each signal, in the order of the subscription's answer.
  readonly columns: readonly Float64Array[];
}

export class BatchError extends Error {}

/// Lays arrays over `buffer` without copying; the times are converted in their place, so a buffer is
/// decoded once.
export function decodeBatch(buffer: ArrayBuffer): SampleBatch {
  if (buffer.byteLength < kHeader) {
    throw new BatchError(`a batch has ${kHeader} bytes at least, not ${buffer.byteLength}`);
  }
  const header = new DataView(buffer);
  if (header.getUint32(0, true) !== kBatchMagic) {
    throw new BatchError("a binary message is no batch of samples of version 1");
  }
  const start = header.getUint32(4, true);
  const rows = header.getUint32(8, true);
  const signals = header.getUint32(12, true);
  const size = start + 8 * rows * (1 + signals);
  if (start < kHeader || start % 8 !== 0 || buffer.byteLength !== size) {
    throw new BatchError(`a batch of ${rows} rows of ${signals} signals has ${size} bytes, not ${buffer.byteLength}`);
  }
  const dropped = header.getUint32(16, true) + header.getUint32(20, true) * 2 ** 32;
  const times = new Float64Array(buffer, start, rows);
  for (let row = 0; row < rows; ++row) {
    const at = start + 8 * row;
    times[row] = header.getUint32(at, true) + header.getInt32(at + 4, true) * 2 ** 32;
  }
  const columns: Float64Array[] = [];
  for (let signal = 0; signal < signals; ++signal) {
    columns.push(columnAt(header, buffer, start + 8 * rows * (1 + signal), rows));
  }
  return { rows, dropped, times, columns };
}

const kLittleEndian = new Uint8Array(new Uint16Array([1]).buffer)[0] === 1;

function columnAt(view: DataView, buffer: ArrayBuffer, start: number, rows: number): Float64Array {
  const column = new Float64Array(buffer, start, rows);
  if (!kLittleEndian) {
    for (let row = 0; row < rows; ++row) {
      column[row] = view.getFloat64(start + 8 * row, true);
    }
  }
  return column;
}
