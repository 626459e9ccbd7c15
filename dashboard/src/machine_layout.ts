// Where the states of a machine stand in its picture, and the way of its arrows.

import type { StateMachine } from "./api";

export interface Box {
  readonly state: string;
  readonly x: number; ///< centre
  readonly y: number;
}

export interface Arrow {
  readonly from: string;
  readonly to: string;
  readonly path: string;
  readonly label: string;
  readonly title: string;
  readonly x: number; ///< of the label
  readonly y: number;
}

export interface Layout {
  readonly width: number;
  readonly height: number;
  readonly boxes: readonly Box[];
  readonly arrows: readonly Arrow[];
}

export const kBoxWidth = 136;
export const kBoxHeight = 26;
const kColumn = 196;
const kRow = 58;

/// Column and row of states, as their standards draw them. Names are compared by their letters.
const kPlaces: Readonly<Record<string, readonly [number, number]>> = {
  // CiA 402-2
  notreadytoswitchon: [0, 0],
  switchondisabled: [0, 1],
  readytoswitchon: [0, 2],
  switchedon: [0, 3],
  operationenabled: [0, 4],
  quickstopactive: [1, 3],
  faultreactionactive: [1, 0.5],
  fault: [1, 1.5],
  // ETG.1000.6
  init: [0, 0],
  preoperational: [0, 1],
  safeoperational: [0, 2],
  operational: [0, 3],
  bootstrap: [1, 0],
  boot: [1, 0],
};

/// CiA 301
const kNmtPlaces: Readonly<Record<string, readonly [number, number]>> = {
  initialisation: [0, 0],
  initializing: [0, 0],
  initialising: [0, 0],
  bootup: [0, 0],
  preoperational: [0, 1],
  operational: [0, 2],
  stopped: [1, 1.5],
};

export function letters(state: string): string {
  return state.toLowerCase().replace(/[^a-z]/g, "");
}

export function sameState(a: string, b: string): boolean {
  return letters(a) === letters(b);
}

function placesOf(machine: StateMachine): Map<string, readonly [number, number]> {
  const known = machine.name === "nmt" ? kNmtPlaces : kPlaces;
  const places = new Map<string, readonly [number, number]>();
  let spare = 0;
  for (const state of machine.states) {
    places.set(letters(state), known[letters(state)] ?? [2, spare++]);
  }
  return places;
}

/// The point of a box's border on the way to another box. Ways there and back keep to their right side.
function border(from: Box, to: Box, shift: number): [number, number] {
  const dx = to.x - from.x;
  const dy = to.y - from.y;
  if (Math.abs(dx) < 1) {
    return [from.x + shift, from.y + (Math.sign(dy) * kBoxHeight) / 2];
  }
  return [from.x + (Math.sign(dx) * kBoxWidth) / 2, from.y + shift * 0.4];
}

export function layOut(machine: StateMachine): Layout {
  const places = placesOf(machine);
  const left = 92; // for the arrows that pass boxes by
  const boxes = machine.states.map((state): Box => {
    const [column, row] = places.get(letters(state)) ?? [0, 0];
    return { state, x: left + kBoxWidth / 2 + column * kColumn, y: 8 + kBoxHeight / 2 + row * kRow };
  });
  const boxOf = (state: string) => boxes.find((box) => sameState(box.state, state));
  const joined = new Map<string, { from: Box; to: Box; numbers: string[]; events: string[] }>();
  for (const transition of machine.transitions) {
    const from = boxOf(transition.from);
    const to = boxOf(transition.to);
    if (!from || !to || from === to) {
      continue;
    }
    const key = `${from.state}>${to.state}`;
    const found = joined.get(key) ?? { from, to, numbers: [], events: [] };
    found.numbers.push(transition.number);
    found.events.push(`${transition.number} ${transition.event}`.trim());
    joined.set(key, found);
  }
  // Ways past other boxes take lanes at the side, the longest outermost.
  const passing = [...joined.values()]
    .filter(({ from, to }) => from.x === to.x && Math.abs(to.y - from.y) > kRow * 1.01)
    .sort((a, b) => Math.abs(a.to.y - a.from.y) - Math.abs(b.to.y - b.from.y) || a.from.y - b.from.y);
  const arrows = [...joined.values()].map(({ from, to, numbers, events }): Arrow => {
    const label = numbers.filter((number) => number !== "").join(", ");
    const title = `${from.state} → ${to.state}: ${events.join("; ")}`;
    const down = to.y > from.y;
    const common = { from: from.state, to: to.state, label, title };
    const lane = passing.findIndex((each) => each.from === from && each.to === to);
    if (lane >= 0) {
      const side = from.x > left + kColumn / 2 ? 1 : -1;
      const distance = 16 + lane * 17;
      const edge = from.x + (side * kBoxWidth) / 2;
      const out = edge + side * distance;
      const [y1, y2] = [from.y + (down ? 6 : -6), to.y + (down ? -6 : 6)];
      const path = `M${edge} ${y1}H${out + -side * 5}Q${out} ${y1} ${out} ${y1 + Math.sign(y2 - y1) * 5}V${
        y2 - Math.sign(y2 - y1) * 5
      }Q${out} ${y2} ${out - side * 5} ${y2}H${edge}`;
      return { ...common, path, x: out, y: (y1 + y2) / 2 };
    }
    const shift = down ? -16 : 16;
    const [x1, y1] = border(from, to, shift);
    const [x2, y2] = border(to, from, shift);
    return { ...common, path: `M${x1} ${y1}L${x2} ${y2}`, x: (x1 + x2) / 2, y: (y1 + y2) / 2 };
  });
  const width = Math.max(...boxes.map((box) => box.x + kBoxWidth / 2)) + (boxes.some((box) => box.x > left + kColumn) ? 56 : 16);
  const height = Math.max(...boxes.map((box) => box.y + kBoxHeight / 2)) + 8;
  return { width, height, boxes, arrows };
}
