import { describe, expect, it } from "vitest";

import { DerivedChannel } from "../../src/scope/core/derived";
import { channelsOf, ExpressionError, parseExpression, unitOf } from "../../src/scope/core/expression";

const kPeriod = 1_000_000; // ns

function evaluate(text: string, columns: Readonly<Record<string, readonly number[]>>, pieces = [1000]): number[] {
  const names = Object.keys(columns);
  const rows = columns[names[0]!]!.length;
  const channel = new DerivedChannel(parseExpression(text), (name) => names.indexOf(name), kPeriod);
  const values: number[] = [];
  for (let start = 0, i = 0; start < rows; ++i) {
    const end = Math.min(rows, start + pieces[i % pieces.length]!);
    const times = Float64Array.from({ length: end - start }, (_, k) => (start + k) * kPeriod);
    values.push(
      ...channel.push(
        times,
        names.map((name) => Float64Array.from(columns[name]!.slice(start, end))),
        end - start,
      ),
    );
    start = end;
  }
  return values;
}

describe("expressions", () => {
  it("know precedence, signs and parentheses", () => {
    const one = { x: [2] };
    expect(evaluate("1 + x * 3", one)).toEqual([7]);
    expect(evaluate("(1 + x) * 3", one)).toEqual([9]);
    expect(evaluate("10 - x - 3", one)).toEqual([5]);
    expect(evaluate("12 / x / 3", one)).toEqual([2]);
    expect(evaluate("-x * -3 + +1", one)).toEqual([7]);
    expect(evaluate("--x", one)).toEqual([2]);
    expect(evaluate("1.5e-3 * x + .5", one)).toEqual([0.503]);
    expect(evaluate("x/0", one)).toEqual([Infinity]);
  });

  it("read channels by name, also in quotes", () => {
    expect(evaluate('gantry.axis0.torque - "x-axis 2"', { "gantry.axis0.torque": [5, 6], "x-axis 2": [1, 3] })).toEqual([4, 3]);
    expect([...channelsOf(parseExpression("a + abs(b.c) * a"))]).toEqual(["a", "b.c"]);
  });

  it("have functions", () => {
    const data = { x: [-4, 2.6] };
    expect(evaluate("abs(x)", data)).toEqual([4, 2.6]);
    expect(evaluate("floor(x)", data)).toEqual([-4, 2]);
    expect(evaluate("round(x)", data)).toEqual([-4, 3]);
    expect(evaluate("min(x, 1)", data)).toEqual([-4, 1]);
    expect(evaluate("max(x, 1)", data)).toEqual([1, 2.6]);
    expect(evaluate("sqrt(x * x)", data)).toEqual([4, 2.6]);
  });

  it.each([[[1000]], [[1]], [[3, 1, 7]]])("differentiate and integrate over time, in pieces of %j", (pieces) => {
    const rows = 200;
    const ramp = Array.from({ length: rows }, (_, i) => i * 1e-3); // equals time
    const slope = evaluate("derivative(3 * x)", { x: ramp }, pieces);
    expect(slope[0]).toBeNaN();
    slope.slice(1).forEach((value) => expect(value).toBeCloseTo(3, 9));
    evaluate("integral(x)", { x: ramp }, pieces).forEach((value, i) => expect(value).toBeCloseTo((i * 1e-3) ** 2 / 2, 12));
    expect(evaluate("integral(derivative(x))", { x: ramp }, pieces)[rows - 1]).toBeCloseTo(ramp[rows - 1]! - ramp[1]!, 9);
  });

  it.each([[[1000]], [[2, 5]]])("average and compare with the past, in pieces of %j", (pieces) => {
    const x = [1, 2, 3, 4, 5, 6, 7, 8];
    expect(evaluate("average(x, 4ms)", { x }, pieces)).toEqual([1, 1.5, 2, 2.5, 3.5, 4.5, 5.5, 6.5]);
    expect(evaluate("delta(x, 0.003)", { x }, pieces)).toEqual([NaN, NaN, NaN, 3, 3, 3, 3, 3]);
  });

  it("skip values that are missing", () => {
    expect(evaluate("average(x, 2ms)", { x: [1, NaN, 3] })).toEqual([1, NaN, 2]);
    expect(evaluate("integral(x)", { x: [1, NaN, 1] })[2]).toBeCloseTo(2e-3, 12);
  });

  it.each([
    ["", "ends where a value is expected", 0],
    ["1 +", "ends where a value is expected", 3],
    ["(a", '")" is missing', 2],
    ["a b", '"b" follows a complete expression', 2],
    ["a ? b", '"?" means nothing here', 2],
    ['"a', 'no closing "', 0],
    ["sine(a)", 'no function "sine"; there are abs', 0],
    ["1 + abs(a, b)", "abs has 1 operand, not 2", 4],
    ["average(a)", "average has 2 operands, not 1", 0],
    ["average(a, b)", "the second operand of average is a time", 0],
    ["delta(a, 0)", "the second operand of delta is a time", 0],
    ["* a", '"*" stands where a value is expected', 0],
    ["toString(a)", "no function", 0],
  ])("say what is wrong with %j", (text, message, position) => {
    try {
      parseExpression(text);
      expect.unreachable();
    } catch (error) {
      expect(error).toBeInstanceOf(ExpressionError);
      expect((error as ExpressionError).message).toContain(message);
      expect((error as ExpressionError).position).toBe(position);
    }
  });

  it("say which channel is not there", () => {
    expect(() => evaluate("x + nothing", { x: [1] })).toThrow('there is no channel "nothing"; add it first (at character 5)');
  });

  it("carry units as far as they follow", () => {
    const units: Record<string, string> = { p: "rev", q: "rev", i: "A", n: "" };
    const unit = (text: string) => unitOf(parseExpression(text), (name) => units[name] ?? "");
    expect(unit("p - q")).toBe("rev");
    expect(unit("abs(p) * 2")).toBe("rev");
    expect(unit("2 * p")).toBe("rev");
    expect(unit("p / 2")).toBe("rev");
    expect(unit("p / q")).toBe("");
    expect(unit("derivative(p)")).toBe("rev/s");
    expect(unit("integral(i)")).toBe("A s");
    expect(unit("average(p, 1ms)")).toBe("rev");
    expect(unit("p + i")).toBe("");
    expect(unit("p * i")).toBe("rev*A");
  });
});
