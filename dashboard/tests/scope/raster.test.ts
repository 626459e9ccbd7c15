import { describe, expect, it } from "vitest";

import { fillSpan, pixelOf } from "../../src/scope/core/raster";

describe("raster", () => {
  it("fills a column between its ends and within its lane", () => {
    const width = 3;
    const filled = (top: number, bottom: number) => {
      const pixels = new Uint32Array(width * 6);
      fillSpan(pixels, width, 1, top, bottom, 1, 5, 7);
      return Array.from({ length: 6 }, (_, y) => pixels[y * width + 1]);
    };
    expect(filled(2, 4)).toEqual([0, 0, 7, 7, 0, 0]);
    expect(filled(-1000, 1e6)).toEqual([0, 7, 7, 7, 7, 0]);
    expect(filled(5, 9)).toEqual([0, 0, 0, 0, 0, 0]);
    const pixels = new Uint32Array(width * 6);
    fillSpan(pixels, width, 1, 0, 6, 0, 6, 7);
    expect([...pixels].filter((pixel) => pixel !== 0)).toHaveLength(6);
  });
  it("reads colours", () => {
    expect(pixelOf("rgb(1, 2, 3)")).toBe(0xff030201);
    expect(pixelOf("rgba(255, 255, 255, 1)")).toBe(0xffffffff);
  });
});
