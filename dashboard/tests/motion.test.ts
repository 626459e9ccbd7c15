import { describe, expect, it } from "vitest";

import { degrees, motorNumbers, motorSignals, motorState, shaftSpeed, slowLimit, Turning, wrapped, type MotorSignals } from "../src/motion";

const kServo = [
  "shaft_position",
  "shaft_speed",
  "direct_current",
  "quadrature_current",
  "current_u",
  "current_v",
  "current_w",
  "duty_u",
  "duty_v",
  "duty_w",
  "supply_voltage",
];
const kStepper = ["shaft_position", "shaft_speed", "coil_current_a", "coil_current_b", "load_angle"];

function motorOf(names: readonly string[]): MotorSignals {
  const motor = motorSignals("d", "axis0", new Set(names.map((name) => `d.axis0.${name}`)));
  if (!motor) {
    throw new Error("no motor");
  }
  return motor;
}

const reading =
  (values: Record<string, number>, units: Record<string, string> = {}) =>
  (signal: string) => {
    const name = signal.slice("d.axis0.".length);
    const value = values[name];
    return value === undefined ? undefined : { value, unit: units[name] ?? "" };
  };

describe("a motor's vectors", () => {
  it("are those of a stepper: the rotor lags the field by the load angle", () => {
    const read = reading({ coil_current_a: 0, coil_current_b: 2, load_angle: 30 }, { load_angle: "deg" });
    const state = motorState(motorOf(kStepper), read);
    expect(state.current.length).toBeCloseTo(2);
    expect(degrees(state.current.angle)).toBeCloseTo(30);
    expect(degrees(state.rotor ?? 0)).toBeCloseTo(60);
  });
  it("take load angles in radians as well", () => {
    const read = reading({ coil_current_a: 1, coil_current_b: 0, load_angle: Math.PI / 2 }, { load_angle: "rad" });
    expect(degrees(motorState(motorOf(kStepper), read).rotor ?? 0)).toBeCloseTo(-90);
  });
  it("do not tell where a rotor stands that no field holds", () => {
    const read = reading({ coil_current_a: 0, coil_current_b: 0, load_angle: 0.4 }, { load_angle: "rad" });
    expect(motorState(motorOf(kStepper), read).rotor).toBeNull();
    expect(motorNumbers(motorOf(kStepper), read)).toContainEqual({ label: "Load angle", text: "no field" });
  });
  it("are those of a servo: current in d/q, voltage of the duties ahead of the rotor", () => {
    const read = reading({
      direct_current: 0,
      quadrature_current: -3,
      current_u: 1.5, // 3 A at -60 degrees, a quarter turn behind a rotor at 30
      current_v: -3,
      current_w: 1.5,
      duty_u: 0.5,
      duty_v: 0.5 + Math.sqrt(3) / 8,
      duty_w: 0.5 - Math.sqrt(3) / 8,
      supply_voltage: 24,
    });
    const { rotor, current, voltage } = motorState(motorOf(kServo), read);
    expect(degrees(rotor ?? 0)).toBeCloseTo(30);
    expect(degrees(current.angle)).toBeCloseTo(-90);
    expect(voltage?.length).toBeCloseTo(6);
    expect(degrees(voltage?.angle ?? 0)).toBeCloseTo(60);
  });
  it("have no voltage where no duties are told", () => {
    const read = reading({ direct_current: 0, quadrature_current: 1, current_u: 1, current_v: -0.5, current_w: -0.5 });
    const { rotor, voltage } = motorState(motorOf(kServo.slice(0, 7)), read);
    expect(degrees(rotor ?? 0)).toBeCloseTo(-90);
    expect(voltage).toBeNull();
  });
  it("are those of two phases where a motor has them, and none of a DC motor", () => {
    const two = { direct_current: 2, quadrature_current: 0, current_u: 0, current_v: 0, current_w: 2, current_y2: -2 };
    expect(degrees(motorState(motorOf(kServo), reading(two)).rotor ?? 0)).toBeCloseTo(90);
    const direct = { direct_current: 0, quadrature_current: 2, current_u: 2, current_v: -2, current_w: 0 };
    expect(motorState(motorOf(kServo), reading(direct)).rotor).toBeNull();
  });
  it("are found of a motor on a board, whose speed is per minute", () => {
    const motor = motorOf(["position", "speed", "current_a", "current_b", "load_angle"]);
    const read = reading({ current_a: 1, current_b: 0, load_angle: 90, speed: 120 }, { load_angle: "degree", speed: "1/min" });
    expect(degrees(motorState(motor, read).rotor ?? 0)).toBeCloseTo(-90);
    expect(shaftSpeed(motor, read)).toBeCloseTo(2);
  });
  it("are drawn of axes that have all signals they need", () => {
    expect(motorSignals("d", "axis0", new Set(["d.axis0.coil_current_a", "d.axis0.coil_current_b"]))).toBeNull();
  });
});

describe("a picture that turns", () => {
  it("follows a slow motor, and rests when it is there", () => {
    const turning = new Turning(slowLimit("servo"));
    turning.advance(0, 0, 0.02);
    let steps = 0;
    while (turning.advance(1, 0, 0.02)) {
      expect(++steps).toBeLessThan(100);
    }
    expect(turning.shown).toBeCloseTo(1, 2);
    expect(turning.slowed).toBe(false);
  });
  it("goes the short way past half a turn", () => {
    const turning = new Turning(1);
    turning.advance(3, 0, 0.02);
    turning.advance(-3, 0, 0.02);
    expect(Math.abs(wrapped(turning.shown - 3))).toBeLessThan(0.3);
    expect(wrapped(turning.shown - 3)).toBeGreaterThan(0);
  });
  it("shows a fast motor slowed, in its direction", () => {
    const turning = new Turning(slowLimit("servo"));
    turning.advance(0, -20, 0.02);
    turning.advance(2, -20, 0.02);
    expect(turning.slowed).toBe(true);
    expect(turning.shown).toBeCloseTo(-0.25 * 2 * Math.PI * 0.02);
  });
});
