// What the oscilloscope shows as part of the page's address, so that it can be passed on.
import { t } from "../../language";
import type { Choosing } from "./presets";
import { type ChannelSetup, type Setup, SetupError, kDefaultSetup, parseSetup, setupText } from "./setup";

const kPlain: Partial<ChannelSetup> = { expression: null, visible: true, gain: 1, offset: 0, own: false };

/// What of `value` is otherwise in `usual`.
function difference(value: object, usual: object): Record<string, unknown> {
  const before = usual as Record<string, unknown>;
  return Object.fromEntries(Object.entries(value).filter(([key, each]) => JSON.stringify(each) !== JSON.stringify(before[key])));
}

export type Query = Record<string, string>;

export function queryOfChoosing({ preset, place: { device, axis } }: Choosing): Query {
  return axis === "" ? { preset: preset.key, device } : { preset: preset.key, device, axis };
}

/// Without what is as usual, since addresses should be short.
export function queryOfSetup(setup: Setup): Query {
  const { channels, ...rest } = setup;
  if (channels.length === 0) {
    return {};
  }
  return { setup: JSON.stringify({ ...difference(rest, kDefaultSetup), channels: channels.map((each) => difference(each, kPlain)) }) };
}

/// Throws SetupError, which says what is wrong and where.
export function setupOfQuery(text: string): Setup {
  let given: { channels?: unknown } | null;
  try {
    given = JSON.parse(text) as typeof given;
  } catch {
    throw new SetupError(t("the address has a setup that is cut off or damaged"));
  }
  const channels = Array.isArray(given?.channels) ? given.channels.map((each: unknown) => ({ ...kPlain, ...(each as object) })) : [];
  const usual = JSON.parse(setupText(kDefaultSetup)) as object;
  return parseSetup(JSON.stringify({ ...usual, ...given, channels }));
}

/// What an address asks for among `offered`, by "preset", "device" and "axis"; each may be missing. Null: there is none.
export function choosingOf(query: ReadonlyMap<string, string>, offered: readonly Choosing[]): Choosing | null {
  const asked = (key: string, value: string) => !query.has(key) || query.get(key) === value;
  return (
    offered.find(({ preset, place }) => asked("preset", preset.key) && asked("device", place.device) && asked("axis", place.axis)) ?? null
  );
}
