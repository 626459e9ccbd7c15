// Vertical lines in an array of pixels: for dense traces many times as fast as paths of a canvas.

/// "rgb(1, 2, 3)" as the 32 bits of an opaque pixel in memory (red first, little-endian).
export function pixelOf(colour: string): number {
  const [red = 0, green = 0, blue = 0] = (colour.match(/[\d.]+/g) ?? []).map(Number);
  return ((255 << 24) | (Math.round(blue) << 16) | (Math.round(green) << 8) | Math.round(red)) >>> 0;
}

/// Fills pixels top <= y < bottom of column `x`, as far as they lie within clipTop <= y < clipBottom.
export function fillSpan(
  pixels: Uint32Array,
  width: number,
  x: number,
  top: number,
  bottom: number,
  clipTop: number,
  clipBottom: number,
  pixel: number,
): void {
  const first = Math.max(top, clipTop);
  const last = Math.min(bottom, clipBottom);
  for (let i = first * width + x, end = last * width + x; i < end; i += width) {
    pixels[i] = pixel;
  }
}
