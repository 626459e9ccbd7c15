import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";

import type { ManualAxis, ManualCommand } from "../src/api";
import { Jog } from "../src/jog";
import { conversion, numberOf, Scale, unitsOf } from "../src/motion_units";
import { controlwordBits } from "../src/words";

const plain = (text: string) => text.replace(/\s/g, " ");

describe("a position or velocity", () => {
  const turns = new Scale("revolutions", "position", 51200);
  const degrees = new Scale("degrees", "position", 51200);
  const device = new Scale("device", "position", 51200);
  it("goes to the device as a whole number of its units", () => {
    expect(turns.toDevice(1.5)).toBe(76800);
    expect(degrees.toDevice(-90)).toBe(-12800);
    expect(degrees.toDevice(1)).toBe(142);
    expect(device.toDevice(76800)).toBe(76800);
  });
  it("is shown in the unit chosen", () => {
    expect(turns.text(-76800)).toBe("−1.500");
    expect(degrees.text(51200 * 10)).toBe("3\u202f600.0");
    expect(plain(device.text(76800))).toBe("76 800");
    expect(turns.text(-1)).toBe("0.000");
    expect(turns.text(null)).toBe("–");
    expect([turns.name, degrees.name, new Scale("revolutions", "velocity", 51200).name]).toEqual(["rev", "°", "rev/s"]);
  });
  it("stands in a field as it would be typed", () => {
    expect(turns.field(76800)).toBe("1.5");
    expect(numberOf(turns.field(-51200))).toBe(-1);
    expect(new Scale("revolutions", "velocity", 60).field(90)).toBe("1.5");
  });
  it("is read with point or comma, and nothing else is taken for a number", () => {
    expect(numberOf(" 1,5 ")).toBe(1.5);
    expect(numberOf("−2.25")).toBe(-2.25);
    expect(numberOf("")).toBeNull();
    expect(numberOf("fast")).toBeNull();
  });
  it("can be had in revolutions where all axes know what one is", () => {
    const axis = (perRevolution: number | null) =>
      ({ position_per_revolution: perRevolution, velocity_per_revolution: perRevolution }) as ManualAxis;
    expect(unitsOf([axis(51200)]).map(({ unit }) => unit)).toEqual(["revolutions", "degrees", "radians", "device"]);
    expect(unitsOf([axis(51200), axis(null)]).map(({ unit }) => unit)).toEqual(["device"]);
  });
});

describe("a signal", () => {
  const stepper = { position: 51200, velocity: 51200 };
  it("that is a position or velocity is shown in the unit chosen", () => {
    expect(conversion("degrees", "rev", null)).toEqual({ unit: "deg", factor: 360 });
    expect(conversion("revolutions", "microstep", stepper)).toEqual({ unit: "rev", factor: 1 / 51200 });
    expect(conversion("revolutions", "pps", stepper)).toEqual({ unit: "rev/s", factor: 1 / 51200 });
    expect(conversion("radians", "1/min", null)).toEqual({ unit: "rad/s", factor: (2 * Math.PI) / 60 });
  });
  it("stays as it is where nothing else is wanted, known or meant", () => {
    expect(conversion("device", "rev", stepper)).toEqual({ unit: "rev", factor: 1 });
    expect(conversion("revolutions", "microstep", null)).toEqual({ unit: "microstep", factor: 1 });
    expect(conversion("revolutions", "deg", stepper)).toEqual({ unit: "deg", factor: 1 }); // electrical
    expect(conversion("revolutions", "A", stepper)).toEqual({ unit: "A", factor: 1 });
  });
});

describe("the controlword", () => {
  const names = (mode: number) => controlwordBits(0x001f, mode).map(({ name }) => name);
  it("has bits 4 to 6 of the mode", () => {
    expect(names(1).slice(4, 7)).toEqual(["new set-point", "change set immediately", "relative"]);
    expect(names(6)[4]).toBe("homing operation start");
    expect(names(3)[4]).toBe("mode specific 4");
    expect(names(1)[8]).toBe("halt");
  });
});

describe("a held button", () => {
  beforeEach(() => void vi.useFakeTimers());
  afterEach(() => void vi.useRealTimers());

  /// A server that answers after `delay` ms.
  const serverOf = (delay: number, takes: (command: ManualCommand) => boolean = () => true) => {
    const commands: string[] = [];
    const send = async (command: ManualCommand) => {
      commands.push(command.value === undefined ? command.command : `${command.command} ${command.value}`);
      await new Promise((done) => setTimeout(done, delay));
      return takes(command);
    };
    return { commands, jog: new Jog(send) };
  };

  it("jogs again until it is let go, then stops", async () => {
    const { commands, jog } = serverOf(0);
    jog.hold(-500);
    await vi.advanceTimersByTimeAsync(310);
    expect(commands).toEqual(["jog -500", "jog -500", "jog -500"]);
    jog.release();
    await vi.advanceTimersByTimeAsync(1000);
    expect(commands.slice(3)).toEqual(["stop"]);
  });
  it("repeats itself more often than a jog holds, which is 400 ms", async () => {
    const { commands, jog } = serverOf(0);
    jog.hold(1);
    await vi.advanceTimersByTimeAsync(399);
    expect(commands.length).toBeGreaterThan(1);
  });
  it("sends the stop after the jog that is under way, never beside it", async () => {
    const { commands, jog } = serverOf(80);
    jog.hold(500);
    await vi.advanceTimersByTimeAsync(10);
    jog.release();
    await vi.advanceTimersByTimeAsync(60);
    expect(commands).toEqual(["jog 500"]);
    await vi.advanceTimersByTimeAsync(20);
    expect(commands).toEqual(["jog 500", "stop"]);
  });
  it("turns the other way at once when the other is pressed while it stops", async () => {
    const { commands, jog } = serverOf(50);
    jog.hold(500);
    await vi.advanceTimersByTimeAsync(10);
    jog.release();
    await vi.advanceTimersByTimeAsync(50);
    jog.hold(-500);
    await vi.advanceTimersByTimeAsync(50);
    expect(commands).toEqual(["jog 500", "stop", "jog -500"]);
    jog.release();
    await vi.advanceTimersByTimeAsync(200);
    expect(commands.at(-1)).toBe("stop");
  });
  it("ends when a jog does not come through, and can be pressed again", async () => {
    const { commands, jog } = serverOf(0, () => false);
    jog.hold(500);
    await vi.advanceTimersByTimeAsync(1000);
    expect(commands).toEqual(["jog 500"]);
    jog.release();
    jog.hold(500);
    await vi.advanceTimersByTimeAsync(0);
    expect(commands).toEqual(["jog 500", "jog 500"]);
  });
});
