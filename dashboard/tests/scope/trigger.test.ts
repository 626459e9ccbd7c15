import { describe, expect, it } from "vitest";

import { Acquisition, eventTriggers, makeDetector, type TriggerSettings, type TriggerSource } from "../../src/scope/core/trigger";

function triggers(source: TriggerSource, values: readonly number[]): number[] {
  const detector = makeDetector(source)!;
  return values.map((value, i) => detector.feed(i * 100, value)).filter((time) => !Number.isNaN(time));
}

const level = (edge: "rising" | "falling" | "either", hysteresis = 0): TriggerSource => ({
  kind: "level",
  channel: "x",
  level: 1,
  hysteresis,
  edge,
});

describe("a level trigger", () => {
  it("finds the edge it is set to, between the samples", () => {
    const values = [0, 0.5, 1.5, 2, 0, 2];
    expect(triggers(level("rising"), values)).toEqual([150, 450]);
    expect(triggers(level("falling"), values)).toEqual([350]);
    expect(triggers(level("either"), values)).toEqual([150, 350, 450]);
  });

  it("does not trigger when it begins beyond the level", () => {
    expect(triggers(level("rising"), [2, 3, 4])).toEqual([]);
    expect(triggers(level("either"), [0.9, 0.8])).toEqual([]);
  });

  it("is not deceived by noise smaller than its hysteresis", () => {
    const values = [0, 1.1, 0.9, 1.1, 0.9, 1.1, 0.4, 1.1];
    expect(triggers(level("rising"), values)).toHaveLength(4);
    expect(triggers(level("rising", 0.5), values)).toHaveLength(2);
  });

  it("does not trigger on a signal that rests at the level", () => {
    expect(triggers(level("either"), [1, 1, 1, 1])).toEqual([]);
  });

  it("goes on after a missing value", () => {
    expect(triggers(level("rising"), [0, NaN, 2])).toEqual([200]);
  });
});

describe("a state trigger", () => {
  it("finds changes", () => {
    expect(triggers({ kind: "state", channel: "x", mask: null, value: null }, [3, 3, 4, 4, 3])).toEqual([200, 400]);
    expect(triggers({ kind: "state", channel: "x", mask: null, value: 4 }, [3, 3, 4, 4, 3])).toEqual([200]);
  });
  it("looks only at the bits of its mask", () => {
    const statuswords = [0x0237, 0x1237, 0x1218, 0x0218, 0x0250];
    expect(triggers({ kind: "state", channel: "x", mask: 0x0008, value: null }, statuswords)).toEqual([200, 400]);
    expect(triggers({ kind: "state", channel: "x", mask: 0x0008, value: 8 }, statuswords)).toEqual([200]);
  });
});

describe("an event trigger", () => {
  const event = { device: "gantry", rule: "stall", severity: "fault" } as const;
  const source = (patch: object): TriggerSource => ({ kind: "event", severity: "warning", device: "", rule: "", ...patch });
  it("takes events that are severe enough, of its device and rule", () => {
    expect(eventTriggers(source({}), event)).toBe(true);
    expect(eventTriggers(source({}), { ...event, severity: "refusal" })).toBe(false);
    expect(eventTriggers(source({ device: "other" }), event)).toBe(false);
    expect(eventTriggers(source({ rule: "stall" }), event)).toBe(true);
    expect(eventTriggers(source({ rule: "other" }), event)).toBe(false);
    expect(eventTriggers({ kind: "none" }, event)).toBe(false);
  });
});

describe("Acquisition", () => {
  const settings = (patch: Partial<TriggerSettings>): TriggerSettings => ({
    mode: "normal",
    source: level("rising"),
    before: 0.25,
    holdOff: 0,
    ...patch,
  });

  it("shows its share before the trigger, once all of the frame has come", () => {
    const acquisition = new Acquisition(settings({}), 1000);
    acquisition.advance(5000);
    expect(acquisition.shown(5000)).toBeNull();
    expect(acquisition.offer(5000)).toBe(true);
    expect(acquisition.state).toBe("triggered");
    acquisition.advance(5749);
    expect(acquisition.frame).toBeNull();
    acquisition.advance(5750);
    expect(acquisition.frame).toEqual({ start: 4750, end: 5750, trigger: 5000 });
    expect(acquisition.state).toBe("waiting");
  });

  it("takes no trigger while a frame is filled or held off", () => {
    const acquisition = new Acquisition(settings({ holdOff: 3000 }), 1000);
    expect(acquisition.offer(5000)).toBe(true);
    expect(acquisition.offer(5100)).toBe(false);
    acquisition.advance(5750);
    expect(acquisition.offer(7999)).toBe(false);
    expect(acquisition.offer(8000)).toBe(true);
  });

  it("stops after one frame when it is single", () => {
    const acquisition = new Acquisition(settings({ mode: "single" }), 1000);
    acquisition.offer(5000);
    acquisition.advance(6000);
    expect(acquisition.state).toBe("done");
    expect(acquisition.offer(9000)).toBe(false);
    acquisition.advance(99_000);
    expect(acquisition.count).toBe(1);
    expect(acquisition.shown(99_000)!.trigger).toBe(5000);
  });

  it("rolls in mode auto when nothing triggers, and not in mode normal", () => {
    const automatic = new Acquisition(settings({ mode: "auto" }), 1e6);
    automatic.advance(0);
    automatic.offer(1e6);
    automatic.advance(2e6);
    expect(automatic.shown(2e6)!.trigger).toBe(1e6);
    automatic.advance(200e6);
    expect(automatic.state).toBe("rolling");
    expect(automatic.shown(200e6)).toEqual({ start: 199e6, end: 200e6, trigger: NaN });
    automatic.offer(201e6);
    automatic.advance(202e6);
    expect(automatic.shown(202e6)!.trigger).toBe(201e6);
    const normal = new Acquisition(settings({}), 1e6);
    normal.offer(1e6);
    normal.advance(500e6);
    expect(normal.shown(500e6)!.trigger).toBe(1e6);
  });

  it("takes an event that comes later than its samples", () => {
    const acquisition = new Acquisition(settings({ source: { kind: "event", severity: "fault", device: "", rule: "" } }), 1000);
    acquisition.advance(50_000);
    expect(acquisition.offer(20_000)).toBe(true);
    acquisition.advance(50_000);
    expect(acquisition.frame).toEqual({ start: 19_750, end: 20_750, trigger: 20_000 });
  });
});
