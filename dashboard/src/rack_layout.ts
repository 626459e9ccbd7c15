// Where devices and cables stand in the picture of a rack. Lengths in pixels.

import type { Port, Segment, WiredDevice } from "./api";
import { t } from "./language";

export const kCardWidth = 210;
export const kGapX = 44;
export const kGapY = 34;
export const kMasterWidth = 84;
const kHeadHeight = 58;
const kShaftHeight = 66;
const kShaftsInRow = 3;

export interface Card {
  readonly name: string;
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

export interface Cable {
  readonly from: string; ///< "master" or a device
  readonly to: string;
  readonly path: string;
  readonly state: "link" | "broken" | "closed";
  readonly title: string;
  /// Middle, for a mark.
  readonly x: number;
  readonly y: number;
}

export interface Picture {
  readonly cards: readonly Card[];
  readonly cables: readonly Cable[];
  readonly width: number;
  readonly height: number;
}

export function cardHeight(shafts: number): number {
  return kHeadHeight + Math.ceil(shafts / kShaftsInRow) * kShaftHeight;
}

/// Where the shafts of a card stand, relative to it.
export function shaftPlace(i: number): { x: number; y: number } {
  return { x: 40 + (i % kShaftsInRow) * 65, y: kHeadHeight + 22 + Math.floor(i / kShaftsInRow) * kShaftHeight };
}

/// Cards in rows from left to right.
export function rows(
  names: readonly string[],
  shafts: (name: string) => number,
  left: number,
  width: number,
): { cards: Card[]; height: number } {
  const inRow = Math.max(1, Math.floor((width - left + kGapX) / (kCardWidth + kGapX)));
  const cards: Card[] = [];
  let y = 0;
  for (let i = 0; i < names.length; i += inRow) {
    const part = names.slice(i, i + inRow);
    const height = Math.max(...part.map((name) => cardHeight(shafts(name))));
    part.forEach((name, column) => {
      cards.push({ name, x: left + column * (kCardWidth + kGapX), y, width: kCardWidth, height });
    });
    y += height + kGapY;
  }
  return { cards, height: Math.max(0, y - kGapY) };
}

function portOf(device: WiredDevice | undefined, number: number | null): Port | undefined {
  return device?.ports.find((port) => port.number === number);
}

function counters(name: string, port: Port | undefined): string {
  if (!port) {
    return "";
  }
  const link = port.link
    ? port.loop_closed
      ? t("link, loop closed")
      : t("link")
    : port.loop_closed
      ? t("no link, loop closed")
      : t("no link");
  return t("{device} port {port}: {link}, invalid frames: {invalid}, RX errors: {rx}, forwarded errors: {forwarded}, lost links: {lost}", {
    device: name,
    port: port.number,
    link,
    invalid: port.invalid_frames,
    rx: port.rx_errors,
    forwarded: port.forwarded_errors,
    lost: port.lost_links,
  });
}

const kCableY = 20; ///< of the sockets, below the card's top

function way(fromX: number, fromY: number, to: Card): { path: string; x: number; y: number } {
  const y = to.y + kCableY;
  if (Math.abs(y - fromY) < 1) {
    return { path: `M${fromX} ${fromY}H${to.x}`, x: (fromX + to.x) / 2, y };
  }
  // Down the gap beside the card, along the gap between the rows, up to the socket.
  const gutter = to.y - kGapY / 2;
  const out = fromX + kGapX / 2;
  const into = to.x - 16;
  return { path: `M${fromX} ${fromY}H${out}V${gutter}H${into}V${y}H${to.x}`, x: (out + into) / 2, y: gutter };
}

/// The picture of a segment: the master at the left, slaves in the order of the frames' way.
export function segmentPicture(segment: Segment, shafts: (name: string) => number, width: number): Picture {
  const left = kMasterWidth + kGapX;
  const names = segment.devices.map((device) => device.name);
  const { cards, height } = rows(names, shafts, left, width);
  const cardOf = (name: string) => cards.find((card) => card.name === name);
  const deviceOf = (name: string) => segment.devices.find((device) => device.name === name);
  const cables: Cable[] = [];
  for (const device of segment.devices) {
    const card = cardOf(device.name);
    if (!card) {
      continue;
    }
    const parent = device.after === null ? undefined : cardOf(device.after);
    const entry = portOf(device, device.entry_port);
    const exit = device.after === null ? undefined : portOf(deviceOf(device.after), device.port);
    const carrier = device.after === null ? (segment.carrier[0] ?? true) : (exit?.link ?? true);
    const whole = carrier && (entry?.link ?? true);
    const closed = (entry?.loop_closed ?? false) || (exit?.loop_closed ?? false);
    const from = parent ? parent.x + parent.width : kMasterWidth;
    const drawn = way(from, parent ? parent.y + kCableY : (cards[0]?.y ?? 0) + kCableY, card);
    cables.push({
      from: device.after ?? "master",
      to: device.name,
      ...drawn,
      state: whole ? (closed ? "closed" : "link") : "broken",
      title: [counters(device.after ?? "master", exit), counters(device.name, entry)].filter((t) => t !== "").join("\n"),
    });
  }
  let bottom = height;
  const last = cards[cards.length - 1];
  if (segment.redundant && last) {
    bottom = height + 26;
    const x = last.x + last.width;
    const y = last.y + kCableY;
    const whole = segment.carrier[1] ?? false;
    cables.push({
      from: last.name,
      to: "master",
      path: `M${x} ${y}H${x + 14}V${bottom - 8}H${kMasterWidth / 2}V${height}`,
      state: whole ? "link" : "broken",
      title: whole ? t("the master's second interface: carrier") : t("the master's second interface: no carrier"),
      x: (x + kMasterWidth) / 2,
      y: bottom - 8,
    });
  }
  const rightmost = Math.max(kMasterWidth, ...cards.map((card) => card.x + card.width));
  return { cards, cables, width: Math.max(width, rightmost), height: Math.max(bottom, cardHeight(0)) };
}

export interface BusPicture {
  readonly cards: readonly Card[];
  /// A horizontal wire above each row of cards, with a drop to every card.
  readonly wires: readonly { readonly y: number; readonly x1: number; readonly x2: number }[];
  readonly width: number;
  readonly height: number;
}

const kDrop = 22;

/// Devices that share one wire: a CAN bus, an RS-485 line.
export function busPicture(names: readonly string[], shafts: (name: string) => number, width: number): BusPicture {
  const left = kMasterWidth + kGapX;
  const { cards, height } = rows(names, shafts, left, width);
  const lowered = cards.map((card) => ({ ...card, y: card.y + kDrop }));
  const tops = [...new Set(lowered.map((card) => card.y))];
  const wires = tops.map((y) => {
    const row = lowered.filter((card) => card.y === y);
    const last = row[row.length - 1];
    return { y: y - kDrop + 6, x1: kMasterWidth, x2: (last?.x ?? left) + kCardWidth / 2 + 30 };
  });
  return { cards: lowered, wires, width, height: height + kDrop };
}
