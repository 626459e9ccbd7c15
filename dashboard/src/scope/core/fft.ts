// Spectrum of a channel: radix-2 transform, windows, amplitudes.

export type WindowName = "rectangular" | "hann" | "hamming" | "blackman-harris" | "flat-top";

/// Coefficients of the cosine sums: w(k) = sum of (-1)^i a[i] cos(2 pi i k / n), periodic form.
export const kWindows: Readonly<Record<WindowName, readonly number[]>> = {
  rectangular: [1],
  hann: [0.5, 0.5],
  hamming: [0.54, 0.46],
  "blackman-harris": [0.35875, 0.48829, 0.14128, 0.01168],
  "flat-top": [0.21557895, 0.41663158, 0.277263158, 0.083578947, 0.006947368],
};

export function windowOf(name: WindowName, length: number): Float64Array {
  const terms = kWindows[name];
  const window = new Float64Array(length);
  for (let k = 0; k < length; ++k) {
    let value = 0;
    for (let i = 0; i < terms.length; ++i) {
      value += (i % 2 === 0 ? 1 : -1) * terms[i]! * Math.cos((2 * Math.PI * i * k) / length);
    }
    window[k] = value;
  }
  return window;
}

/// The discrete Fourier transform of `real` + i `imaginary`, in place; their length is a power of 2.
export function transform(real: Float64Array, imaginary: Float64Array): void {
  const length = real.length;
  if (length < 1 || (length & (length - 1)) !== 0 || imaginary.length !== length) {
    throw new RangeError(`a transform has a power of 2 of values, not ${length}`);
  }
  for (let i = 1, j = 0; i < length; ++i) {
    let bit = length >> 1;
    for (; (j & bit) !== 0; bit >>= 1) {
      j ^= bit;
    }
    j ^= bit;
    if (i < j) {
      [real[i], real[j]] = [real[j]!, real[i]!];
      [imaginary[i], imaginary[j]] = [imaginary[j]!, imaginary[i]!];
    }
  }
  const half = length >> 1;
  const cosine = new Float64Array(half);
  const sine = new Float64Array(half);
  for (let k = 0; k < half; ++k) {
    cosine[k] = Math.cos((2 * Math.PI * k) / length);
    sine[k] = -Math.sin((2 * Math.PI * k) / length);
  }
  for (let size = 2; size <= length; size *= 2) {
    const step = length / size;
    for (let start = 0; start < length; start += size) {
      for (let k = 0; k < size / 2; ++k) {
        const even = start + k;
        const odd = even + size / 2;
        const c = cosine[k * step]!;
        const s = sine[k * step]!;
        const re = real[odd]! * c - imaginary[odd]! * s;
        const im = real[odd]! * s + imaginary[odd]! * c;
        real[odd] = real[even]! - re;
        imaginary[odd] = imaginary[even]! - im;
        real[even] = real[even]! + re;
        imaginary[even] = imaginary[even]! + im;
      }
    }
  }
}

export interface Spectrum {
  /// Distance of two lines, Hz.
  readonly resolution: number;
  /// Amplitude (peak) of the sine at each line, from 0 Hz to half the sampling frequency, in the
  /// channel's unit; the window's gain is taken out.
  readonly amplitude: Float64Array;
}

/// Of `samples` (a power of 2 of them) at `frequency` Hz. `removeMean`: without the constant part,
/// whose leakage may cover low frequencies.
export function spectrumOf(samples: Float64Array, frequency: number, window: WindowName, removeMean: boolean): Spectrum {
  const length = samples.length;
  const weights = windowOf(window, length);
  let gain = 0;
  let weighted = 0;
  for (let k = 0; k < length; ++k) {
    gain += weights[k]!;
    weighted += weights[k]! * samples[k]!;
  }
  const mean = removeMean ? weighted / gain : 0;
  const real = new Float64Array(length);
  const imaginary = new Float64Array(length);
  for (let k = 0; k < length; ++k) {
    real[k] = (samples[k]! - mean) * weights[k]!;
  }
  transform(real, imaginary);
  const lines = length / 2 + 1;
  const amplitude = new Float64Array(lines);
  for (let k = 0; k < lines; ++k) {
    const twice = k === 0 || k === length / 2 ? 1 : 2;
    amplitude[k] = (twice * Math.hypot(real[k]!, imaginary[k]!)) / gain;
  }
  return { resolution: frequency / length, amplitude };
}

/// Amplitude in dB of one unit; nothing below `floor`.
export function decibels(amplitude: number, floor = -200): number {
  return Math.max(floor, 20 * Math.log10(amplitude));
}
