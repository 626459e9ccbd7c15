// Dense traces, drawn pixel by pixel and laid over the grid at once.
import type { Envelope } from "./core/decimation";
import { fillSpan } from "./core/raster";

const kThick = 1.5; // of a trace that stands still, CSS pixels

export class TraceLayer {
  private readonly canvas = new OffscreenCanvas(1, 1);
  private readonly context = this.canvas.getContext("2d")!;
  private image = this.context.createImageData(1, 1);
  private pixels = new Uint32Array(this.image.data.buffer);
  private used = false;

  /// An empty layer of so many device pixels.
  begin(width: number, height: number): void {
    if (this.image.width !== width || this.image.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
      this.image = this.context.createImageData(width, height);
      this.pixels = new Uint32Array(this.image.data.buffer);
    } else if (this.used) {
      this.pixels.fill(0);
    }
    this.used = false;
  }

  /// One column of pixels for each of the envelope's, at y = value * slope + zero, between two heights.
  trace(envelope: Envelope, slope: number, zero: number, top: number, bottom: number, pixel: number, ratio: number): void {
    this.used = true;
    const { low, high } = envelope;
    const { width } = this.image;
    const thick = kThick * ratio;
    for (let x = 0; x < width; ++x) {
      if (low[x]! <= high[x]!) {
        const a = low[x]! * slope + zero;
        const b = high[x]! * slope + zero;
        const from = Math.round((a < b ? a : b) - thick / 2);
        const to = Math.max(from + 1, Math.round((a < b ? b : a) + thick / 2));
        fillSpan(this.pixels, width, x, from, to, top, bottom, pixel);
      }
    }
  }

  /// `context` draws in device pixels.
  end(context: CanvasRenderingContext2D, left: number, top: number): void {
    if (this.used) {
      this.context.putImageData(this.image, 0, 0);
      context.drawImage(this.canvas, left, top);
    }
  }
}
