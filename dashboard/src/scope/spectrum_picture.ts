// Draws the spectra of the visible channels.
import { type Spectrum, decibels, spectrumOf } from "./core/fft";
import { frequencyText, tickText, ticks } from "./core/numbers";
import { type Range, fitted } from "./core/view";
import type { Oscilloscope } from "./oscilloscope";
import { type Colours, line } from "./picture";

export interface ChannelSpectrum {
  readonly channel: number;
  readonly spectrum: Spectrum;
  /// The highest line above 0 Hz.
  readonly peakFrequency: number;
  readonly peak: number;
}

const kLeft = 64;
const kBottom = 22;
const kTop = 6;
const kFloor = -200;

/// Of the newest samples that are looked at and have no gap; fewer than `points` if there are not so
/// many, none below 16.
export function spectraOf(scope: Oscilloscope): ChannelSpectrum[] {
  const { ring } = scope.record;
  const { channels, period, spectrum } = scope.setup;
  const rows = scope.measuredRows();
  let from = rows.from;
  for (const gap of scope.record.gaps) {
    const after = ring.lowerBound(gap.to);
    from = after > from && after < rows.to ? after : from;
  }
  const kFewest = 16;
  const available = Math.min(spectrum.points, rows.to - from);
  if (available < kFewest) {
    return [];
  }
  const points = 2 ** Math.floor(Math.log2(available));
  const samples = new Float64Array(points);
  const found: ChannelSpectrum[] = [];
  channels.forEach((channel, column) => {
    if (!channel.visible) {
      return;
    }
    const { factor } = scope.display(channel);
    let complete = true;
    for (let i = 0; i < points; ++i) {
      samples[i] = ring.value(column, rows.to - points + i) * factor;
      complete &&= Number.isFinite(samples[i]);
    }
    if (!complete) {
      return;
    }
    const result = spectrumOf(samples, 1e9 / period, spectrum.window, spectrum.removeMean);
    let best = 1;
    for (let k = 2; k < result.amplitude.length; ++k) {
      best = result.amplitude[k]! > result.amplitude[best]! ? k : best;
    }
    found.push({ channel: column, spectrum: result, peakFrequency: best * result.resolution, peak: result.amplitude[best]! });
  });
  return found;
}

let range: Range | null = null;

export function drawSpectra(
  canvas: HTMLCanvasElement,
  colours: Colours,
  spectra: readonly ChannelSpectrum[],
  inDecibels: boolean,
  highest: number,
): void {
  const context = canvas.getContext("2d")!;
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.fillStyle = colours.surface;
  context.fillRect(0, 0, width, height);
  context.font = `11px ${getComputedStyle(canvas).fontFamily}`;
  const right = width - 10;
  const bottom = height - kBottom;
  const value = (amplitude: number) => (inDecibels ? decibels(amplitude, kFloor) : amplitude);
  let low = Infinity;
  let high = -Infinity;
  for (const { spectrum } of spectra) {
    for (const amplitude of spectrum.amplitude) {
      low = Math.min(low, value(amplitude));
      high = Math.max(high, value(amplitude));
    }
  }
  range = fitted(inDecibels ? Math.max(low, high - 140) : 0, high, range);
  const { from, to } = range;
  const x = (frequency: number) => kLeft + (frequency / highest) * (right - kLeft);
  const y = (level: number) => bottom - ((level - from) / (to - from)) * (bottom - kTop);
  context.lineWidth = 1;
  context.strokeStyle = colours.grid;
  context.fillStyle = colours.soft;
  context.textAlign = "center";
  context.textBaseline = "top";
  for (const at of ticks(0, highest, (right - kLeft) / 90).at) {
    line(context, x(at), kTop, x(at), bottom);
    context.fillText(frequencyText(at, 4), x(at), bottom + 5);
  }
  context.textAlign = "right";
  context.textBaseline = "middle";
  const levels = ticks(from, to, (bottom - kTop) / 26);
  for (const at of levels.at) {
    line(context, kLeft, y(at), right, y(at));
    context.fillText(tickText(at, levels.step) + (inDecibels ? " dB" : ""), kLeft - 5, y(at));
  }
  context.strokeStyle = colours.border;
  context.strokeRect(kLeft + 0.5, kTop + 0.5, right - kLeft - 1, bottom - kTop - 1);
  context.save();
  context.beginPath();
  context.rect(kLeft, kTop, right - kLeft, bottom - kTop);
  context.clip();
  for (const { channel, spectrum } of spectra) {
    context.strokeStyle = colours.series[channel % colours.series.length]!;
    context.beginPath();
    // As in time, each column of pixels shows its highest line.
    const lines = spectrum.amplitude.length;
    const perPixel = Math.max(1, highest / spectrum.resolution / (right - kLeft));
    for (let k = 0; k < lines; k += perPixel) {
      let top = 0;
      for (let i = Math.floor(k); i < Math.min(lines, Math.floor(k + perPixel)); ++i) {
        top = Math.max(top, spectrum.amplitude[i]!);
      }
      context.lineTo(x(Math.floor(k) * spectrum.resolution), y(value(top)));
    }
    context.stroke();
  }
  context.restore();
}
