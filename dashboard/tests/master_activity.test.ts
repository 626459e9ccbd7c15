import { describe, expect, it } from "vitest";

import { MasterActivity } from "../src/master_activity";

/// Looks each second at a master that sends `frames` every `period` milliseconds until `end`.
function watched(period: number, frames: number, end: number): MasterActivity {
  const activity = new MasterActivity();
  for (let now = 0; now <= end; now += 1000) {
    activity.look(Math.floor(now / period) * frames, now);
  }
  return activity;
}

describe("a master", () => {
  it("with a cycle of a millisecond is silent after three seconds", () => {
    const activity = watched(1, 1, 20_000);
    expect(activity.silence(22_000)).toBeNull();
    expect(activity.silence(23_500)).toBe(3500);
  });
  it("that looks every ten seconds is not silent between two looks", () => {
    const activity = watched(10_000, 1, 60_000);
    expect(activity.silence(69_000)).toBeNull();
    expect(activity.silence(100_000)).toBeNull();
    expect(activity.silence(115_000)).toBe(55_000);
  });
  it("that has a cycle and pauses between its moves goes by the frames it sends", () => {
    const activity = watched(2000, 500, 60_000);
    expect(activity.silence(62_000)).toBeNull();
    expect(activity.silence(64_000)).toBe(4000);
  });
  it("that never spoke is silent since the page looks", () => {
    const activity = new MasterActivity();
    expect(activity.silence(5000)).toBeNull();
    for (let now = 1000; now <= 9000; now += 1000) {
      activity.look(0, now);
    }
    expect(activity.hasSpoken).toBe(false);
    expect(activity.silence(9000)).toBe(8000);
  });
  it("begins anew with another run", () => {
    const activity = watched(1, 1, 20_000);
    activity.look(0, 30_000);
    expect(activity.silence(31_000)).toBeNull();
    activity.look(5, 31_000);
    expect(activity.silence(33_000)).toBeNull();
    expect(activity.hasSpoken).toBe(true);
  });
});
