import { describe, expect, it } from "vitest";

import type { Frame } from "../src/api";
import { TrafficLog, kRepeats, kindOf, valuesOf } from "../src/traffic_log";

let number = 0;

function frame(patch: Partial<Frame>): Frame {
  number += 1;
  return { number, time_ns: number * 1e6, network: "segment 0", direction: "answer", summary: "", fields: [], raw: "", ...patch };
}

/// Process data of a cycle, `value` being what the drive says.
const cyclic = (value: string, wkc = 3) =>
  frame({
    summary: `LRW 00000000h, 30 bytes, WKC ${wkc}`,
    fields: [
      ["datagram 1", `LRW 00000000h, 30 bytes, WKC ${wkc}`],
      ["gantry 6041h Statusword", value],
    ],
  });
const sdo = (value: string) =>
  frame({
    summary: "FPRD 1001h gantry 1080h, 128 bytes, WKC 1: SDO answer 6041h",
    fields: [
      ["datagram 1", "FPRD 1001h gantry 1080h, 128 bytes, WKC 1: SDO answer 6041h"],
      ["mailbox", "CoE, counter 1, 10 bytes"],
      ["value", value],
    ],
  });
const pdo = (data: string) =>
  frame({
    network: "can0",
    direction: "bus",
    summary: "185h PDO TPDO1, spindle",
    fields: [
      ["identifier", "185h"],
      ["length", "2"],
      ["6041h", data],
    ],
  });

describe("the kind of a frame", () => {
  it("is the same whatever the process data, and another with another working counter", () => {
    expect(kindOf(cyclic("1"))).toBe(kindOf(cyclic("2")));
    expect(kindOf(cyclic("1"))).not.toBe(kindOf(cyclic("1", 2)));
    expect(kindOf(cyclic("1"))).not.toBe(kindOf({ ...cyclic("1"), direction: "request" }));
    expect(kindOf(pdo("1"))).toBe(kindOf(pdo("2")));
  });
  it("is none for what is said once", () => {
    expect(kindOf(sdo("1"))).toBeNull();
    for (const summary of [
      "605h SDO upload 6041h, node 5 spindle",
      "085h EMCY 8611h, node 5",
      "000h NMT operational, all nodes",
      "CAN frame",
    ]) {
      expect(kindOf(frame({ summary, fields: [["identifier", "605h"]] }))).toBeNull();
    }
  });
  it("keeps apart what registers say of the state", () => {
    const status = (state: string) => frame({ fields: [["datagram 1", `BRD 0130h AL status, 2 bytes, WKC 3: ${state}`]] });
    expect(kindOf(status("Operational"))).not.toBe(kindOf(status("Safe-Operational")));
  });
});

describe("the values of a frame", () => {
  it("are its objects", () => {
    expect(valuesOf(cyclic("1237h"))).toEqual([["gantry 6041h Statusword", "1237h"]]);
    expect(valuesOf(pdo("0637h"))).toEqual([["6041h", "0637h"]]);
  });
});

describe("the log of frames", () => {
  it("counts each frame once", () => {
    const log = new TrafficLog();
    const made = Array.from({ length: 3000 }, (_, i) => [cyclic(String(i)), i % 100 === 0 ? sdo(String(i)) : pdo(String(i))]).flat();
    for (let i = 0; i < made.length; i += 37) {
      log.take(made.slice(i, i + 37));
    }
    expect(log.received).toBe(6000);
    expect(log.single).toBe(30);
    expect(log.repeating.map(({ count }) => count)).toEqual([3000, 2970]);
    expect(log.repeating[0]!.last).toBe(made.at(-2));
    expect(log.newestOf("single", 100, () => true).map(({ fields }) => fields[2]![1])[0]).toBe("2900");
    expect(log.newestOf("all", 5000, () => true)).toHaveLength(5000);
  });
  it("shows frames alone until they repeat, then moves them", () => {
    const log = new TrafficLog();
    const singles = () => log.newestOf("single", 10, () => true).length;
    for (let i = 1; i < kRepeats; ++i) {
      log.take([cyclic("")]);
      expect([log.single, singles(), log.repeating.length]).toEqual([i, i, 0]);
    }
    log.take([cyclic("")]);
    expect([log.single, singles(), log.repeating.length]).toEqual([0, 0, 1]);
  });
  it("tells how often per second of simulated time", () => {
    const log = new TrafficLog();
    for (let i = 0; i < 3000; ++i) {
      log.take([{ ...cyclic(""), time_ns: i * 2e6 }]);
    }
    expect(log.repeating[0]!.rate).toBeCloseTo(500, 6);
    for (let i = 0; i < 30; ++i) {
      log.take([{ ...cyclic(""), time_ns: 6e9 + i * 100e6 }]);
    }
    expect(log.repeating[0]!.rate).toBeCloseTo(10, 6);
    expect(log.repeating[0]!.recent).toHaveLength(20);
  });
  it("keeps within its limits, and counts what it no longer shows", () => {
    const log = new TrafficLog({ frames: 10, recent: 2, kinds: 20 });
    const register = (address: number) => frame({ fields: [["datagram 1", `FPRD 1001h ${address}`]] });
    log.take(Array.from({ length: 500 }, (_, i) => register(i)));
    log.take(Array.from({ length: 5 }, () => cyclic("")));
    expect(log.received).toBe(505);
    expect(log.single).toBe(500);
    expect(log.repeating.map(({ count }) => count)).toEqual([5]);
    expect(log.newestOf("single", 1000, () => true).length).toBeLessThanOrEqual(20);
    expect(log.newestOf("all", 1000, () => true).length).toBeLessThanOrEqual(20);
  });
});
