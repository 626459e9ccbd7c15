import { describe, expect, it } from "vitest";

import type { Entry, Port, Segment, StateMachine } from "../src/api";
import { axisIndex } from "../src/axes";
import { rangeFor } from "../src/components/gauge";
import { limitObjects, limitsOf } from "../src/limits";
import { kBoxHeight, kBoxWidth, layOut } from "../src/machine_layout";
import { busPicture, rows, segmentPicture } from "../src/rack_layout";
import { shaftDegrees, shaftsOf } from "../src/shafts";

const port = (number: number, link: boolean): Port => ({
  number,
  link,
  loop_closed: false,
  neighbour: null,
  invalid_frames: 0,
  rx_errors: 0,
  forwarded_errors: 0,
  lost_links: 0,
});

function line(count: number, broken = -1): Segment {
  return {
    name: "segment 0",
    link: "",
    redundant: false,
    carrier: [true],
    devices: Array.from({ length: count }, (_, i) => ({
      name: `d${i}`,
      after: i === 0 ? null : `d${i - 1}`,
      port: 1,
      entry_port: 0,
      ports: [port(0, i !== broken), port(1, i + 1 !== broken)],
    })),
  };
}

describe("the picture of a segment", () => {
  it("fits into the width and keeps cards apart", () => {
    const { cards } = segmentPicture(line(20), (name) => name.length, 1030);
    for (const card of cards) {
      expect(card.x + card.width).toBeLessThanOrEqual(1030);
      for (const other of cards.filter((each) => each !== card)) {
        const apart =
          card.x + card.width <= other.x ||
          other.x + other.width <= card.x ||
          card.y + card.height <= other.y ||
          other.y + other.height <= card.y;
        expect(apart).toBe(true);
      }
    }
  });
  it("has one cable for every device, and shows the one that is broken", () => {
    const { cables } = segmentPicture(line(4, 2), () => 1, 1030);
    expect(cables.map(({ from, to, state }) => `${from} ${to} ${state}`)).toEqual([
      "master d0 link",
      "d0 d1 link",
      "d1 d2 broken",
      "d2 d3 link",
    ]);
  });
  it("leads back to the master with cable redundancy", () => {
    const ring = { ...line(3), redundant: true, carrier: [true, false] };
    const { cables } = segmentPicture(ring, () => 1, 1030);
    expect(cables[3]).toMatchObject({ from: "d2", to: "master", state: "broken" });
  });
  it("is drawn for a segment without devices", () => {
    expect(segmentPicture(line(0), () => 0, 1030).cables).toEqual([]);
  });
  it("has at least one card in a row however narrow it is", () => {
    expect(rows(["a", "b"], () => 1, 128, 100).cards.map(({ x }) => x)).toEqual([128, 128]);
  });
});

describe("the picture of a bus", () => {
  it("has a wire above every row", () => {
    const { wires, cards } = busPicture(["a", "b", "c", "d", "e"], () => 1, 700);
    expect(wires).toHaveLength(new Set(cards.map(({ y }) => y)).size);
  });
});

const machine: StateMachine = {
  name: "cia402",
  title: "",
  states: [
    "Not ready to switch on",
    "Switch on disabled",
    "Ready to switch on",
    "Switched on",
    "Operation enabled",
    "Quick stop active",
    "Fault reaction active",
    "Fault",
    "Something new",
  ],
  transitions: [
    { from: "Switched on", to: "Operation enabled", number: "4", event: "" },
    { from: "Operation enabled", to: "Switched on", number: "5", event: "" },
    { from: "Operation enabled", to: "Ready to switch on", number: "8", event: "" },
    { from: "Operation enabled", to: "Switch on disabled", number: "9", event: "" },
    { from: "Switched on", to: "Switch on disabled", number: "10", event: "" },
    { from: "Fault", to: "Nowhere", number: "99", event: "" },
  ],
};

describe("the picture of a state machine", () => {
  const layout = layOut(machine);
  it("keeps states apart, also those it does not know, and inside", () => {
    for (const box of layout.boxes) {
      expect(box.x + kBoxWidth / 2).toBeLessThanOrEqual(layout.width);
      for (const other of layout.boxes.filter((each) => each !== box)) {
        expect(Math.abs(box.x - other.x) >= kBoxWidth || Math.abs(box.y - other.y) >= kBoxHeight).toBe(true);
      }
    }
  });
  it("keeps arrows' labels apart", () => {
    const labels = layout.arrows.map(({ x, y }) => `${Math.round(x / 8)} ${Math.round(y / 8)}`);
    expect(new Set(labels).size).toBe(labels.length);
  });
  it("leaves out ways to states it does not have", () => {
    expect(layout.arrows.map(({ label }) => label)).toEqual(["4", "5", "8", "9", "10"]);
  });
  it("draws once what leads from many states to one", () => {
    const many = ["Switched on", "Operation enabled", "Quick stop active"].map((from) => ({
      from,
      to: "Fault reaction active",
      number: "13",
      event: "fault",
    }));
    const drawn = layOut({ ...machine, transitions: many }).arrows;
    expect(drawn.map(({ label, from }) => [label, from.length])).toEqual([["13", 3]]);
  });
  it("joins transitions with the same ends", () => {
    const twice = {
      ...machine,
      transitions: [...machine.transitions, { from: "Switched on", to: "Operation enabled", number: "4b", event: "" }],
    };
    expect(layOut(twice).arrows[0]?.label).toBe("4, 4b");
  });
});

describe("shafts", () => {
  it("are what stands in revolutions", () => {
    const signals = [
      { name: "gantry.axis0.shaft_position", unit: "rev", value: 0 },
      { name: "gantry.axis0.shaft_speed", unit: "rev/s", value: 0 },
      { name: "gantry.z.fan.position", unit: "rev", value: 0 },
      { name: "other.axis0.shaft_position", unit: "rev", value: 0 },
    ];
    expect(shaftsOf(signals, ["gantry", "gantry.z"])).toEqual([
      { device: "gantry", name: "axis0", signal: "gantry.axis0.shaft_position" },
      { device: "gantry.z", name: "fan", signal: "gantry.z.fan.position" },
    ]);
  });
  it("turn once per revolution, backwards too", () => {
    expect(shaftDegrees(106.75)).toBe(270);
    expect(shaftDegrees(-0.25)).toBe(270);
  });
});

describe("the range of a gauge", () => {
  it("is 1, 2 or 5 times a power of ten, symmetric once anything was negative", () => {
    expect(rangeFor({ low: 0, high: 48 })).toMatchObject({ minimum: 0, maximum: 50 });
    expect(rangeFor({ low: -1.6, high: 1.2 })).toMatchObject({ minimum: -2, maximum: 2 });
  });
  it("is one unit at rest, and no shorter than what is shown to differ from nothing", () => {
    expect(rangeFor({ low: 0, high: 0 }, "increment")).toMatchObject({ minimum: 0, maximum: 1 });
    expect(rangeFor({ low: 0, high: 1e-7 }, "rev/s").maximum).toBe(0.001);
    expect(rangeFor({ low: 0, high: 1e-9 }, "A").maximum).toBe(1e-6);
  });
  it("holds limits that are not too far from what has been seen", () => {
    const limits = [
      { name: "least", value: -100 },
      { name: "most", value: 90_000 },
    ];
    expect(rangeFor({ low: 0, high: 40 }, "increment", limits)).toMatchObject({ minimum: -100, maximum: 100 });
    expect(rangeFor({ low: 0, high: 0 }, "increment", limits)).toMatchObject({ minimum: -100_000, maximum: 100_000 });
  });
});

describe("the limits of a bar", () => {
  const at = (index: number) => axisIndex(index, 1);
  const entry = (index: string, subindex: string, value: number) => ({ index, subindex, value }) as Entry;
  const read = (...entries: Entry[]) => [{ device: "gantry", entries }];
  it("come from the objects of the axis that the device has", () => {
    const declared = [entry("687D", "01", 0), entry("6065", "00", 0), entry("6880", "00", 0)];
    expect(limitObjects("gantry.axis1.position_actual", declared, at)).toEqual(["687D"]);
    expect(limitObjects("gantry.axis1.velocity_actual", declared, at)).toEqual(["6880"]);
    expect(limitObjects("gantry.axis1.following_error", declared, at)).toEqual([]);
    expect(limitObjects("gantry.axis1.torque", declared, at)).toEqual([]);
  });
  it("are those of the signal, a window on either side", () => {
    const window = read(entry("6865", "00", 500));
    expect(limitsOf("gantry.axis1.following_error", window, at).map(({ value }) => value)).toEqual([-500, 500]);
    expect(limitsOf("gantry.axis1.position_actual", window, at)).toEqual([]);
    const ends = read(entry("687D", "00", 2), entry("687D", "01", 0), entry("687D", "02", 80_000));
    expect(limitsOf("gantry.axis1.position_actual", ends, at).map(({ value }) => value)).toEqual([0, 80_000]);
  });
  it("are none where the object allows all, or nothing is watched", () => {
    const ends = read(entry("687D", "01", -(2 ** 31)), entry("687D", "02", 2 ** 31 - 1));
    expect(limitsOf("gantry.axis1.position_actual", ends, at)).toEqual([]);
    expect(limitsOf("gantry.axis1.position_actual", read(entry("687D", "01", 0), entry("687D", "02", 0)), at)).toEqual([]);
    expect(limitsOf("gantry.axis1.following_error", read(entry("6865", "00", 2 ** 32 - 1)), at)).toEqual([]);
    expect(limitsOf("gantry.axis1.following_error", read(entry("6865", "00", 0)), at)).toEqual([]);
  });
});
