import { describe, expect, it } from "vitest";

import { decibels, kWindows, spectrumOf, transform, type WindowName, windowOf } from "../../src/scope/core/fft";

const kRate = 20_000;

function tones(length: number, parts: readonly (readonly [frequency: number, amplitude: number])[], offset = 0): Float64Array {
  return Float64Array.from({ length }, (_, i) =>
    parts.reduce((sum, [frequency, amplitude]) => sum + amplitude * Math.cos((2 * Math.PI * frequency * i) / kRate), offset),
  );
}

describe("transform", () => {
  it("is the sum that defines it", () => {
    const length = 64;
    const real = Float64Array.from({ length }, (_, i) => Math.sin(i * i));
    const imaginary = Float64Array.from({ length }, (_, i) => Math.cos(3 * i * i));
    const re = real.slice();
    const im = imaginary.slice();
    transform(re, im);
    for (let k = 0; k < length; ++k) {
      let a = 0;
      let b = 0;
      for (let n = 0; n < length; ++n) {
        const angle = (-2 * Math.PI * k * n) / length;
        a += real[n]! * Math.cos(angle) - imaginary[n]! * Math.sin(angle);
        b += real[n]! * Math.sin(angle) + imaginary[n]! * Math.cos(angle);
      }
      expect(re[k]).toBeCloseTo(a, 10);
      expect(im[k]).toBeCloseTo(b, 10);
    }
  });
  it("keeps energy (Parseval)", () => {
    const real = Float64Array.from({ length: 4096 }, (_, i) => Math.sin(i * i));
    const energy = real.reduce((sum, value) => sum + value * value, 0);
    const imaginary = new Float64Array(4096);
    transform(real, imaginary);
    expect(real.reduce((sum, value, i) => sum + value * value + imaginary[i]! ** 2, 0) / 4096).toBeCloseTo(energy, 6);
  });
  it("wants a power of 2", () => {
    expect(() => transform(new Float64Array(12), new Float64Array(12))).toThrow("power of 2");
    transform(new Float64Array(1), new Float64Array(1));
  });
});

describe("spectrumOf", () => {
  const line = kRate / 4096;
  it.each(Object.keys(kWindows) as WindowName[])("says a tone's amplitude through the window %s", (window) => {
    const { amplitude, resolution } = spectrumOf(tones(4096, [[200 * line, 3]]), kRate, window, false);
    expect(resolution).toBe(line);
    expect(amplitude).toHaveLength(2049);
    expect(amplitude[200]).toBeCloseTo(3, 6);
    expect(amplitude[1000]).toBeLessThan(1e-9);
  });
  it("shows a constant at 0 Hz once, or not at all without the mean", () => {
    const samples = tones(1024, [[kRate / 8, 1]], 5);
    expect(spectrumOf(samples, kRate, "hann", false).amplitude[0]).toBeCloseTo(5, 9);
    expect(spectrumOf(samples, kRate, "hann", true).amplitude[0]).toBeLessThan(1e-9);
    expect(spectrumOf(tones(1024, [[kRate / 2, 2]]), kRate, "rectangular", false).amplitude[512]).toBeCloseTo(2, 9);
  });
  it("reads a tone between two lines within 0.1 % through a flat top", () => {
    const { amplitude } = spectrumOf(tones(4096, [[200.5 * line, 1]]), kRate, "flat-top", false);
    expect(Math.max(...amplitude)).toBeGreaterThan(0.998);
    expect(Math.max(...amplitude)).toBeLessThan(1.001);
  });
  it("separates a small tone from a large one with low side lobes", () => {
    const { amplitude } = spectrumOf(
      tones(4096, [
        [200.5 * line, 1],
        [260 * line, 1e-4],
      ]),
      kRate,
      "blackman-harris",
      false,
    );
    expect(decibels(amplitude[260]!)).toBeCloseTo(-80, 0);
    expect(decibels(amplitude[240]!)).toBeLessThan(-92);
  });
});

describe("windowOf", () => {
  it("is periodic, with its maximum in the middle", () => {
    const hann = windowOf("hann", 8);
    expect(hann[0]).toBeCloseTo(0, 12);
    expect(hann[4]).toBeCloseTo(1, 12);
    expect(hann[3]).toBeCloseTo(hann[5]!, 12);
  });
});

describe("decibels", () => {
  it("has a floor", () => {
    expect(decibels(10)).toBeCloseTo(20, 12);
    expect(decibels(0)).toBe(-200);
  });
});
