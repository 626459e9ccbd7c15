// Homing by hand: which way home is found, and whether it is.
import { useState } from "preact/hooks";

import { segment, type Entry, type Object as DeviceObject, type Objects } from "../api";
import { axisIndex } from "../axes";
import { useAction, useResource, useWorld } from "../hooks";
import { t, tx } from "../language";
import { href } from "../router";
import { homingMethodText, homingText, kUsualHomingMethods } from "../words";

/// Mode of operation (6061h).
export const kHoming = 6;

const kMethod = 0x6098;
const kSupportedMethods = 0x60e3;
/// Methods that search for a switch.
const kBySwitch: ReadonlySet<number> = new Set([1, 2, 3, 5, 17, 18, 19, 21]);

export function HomingBadge({ statusword }: { statusword: number }) {
  const { text, kind } = homingText(statusword);
  return (
    <span class={`badge ${kind}`} role="status">
      {text}
    </span>
  );
}

function objectsPath(device: string): string {
  return `/api/v1/devices/${segment(device)}/objects`;
}

/// What the drive says of the methods it has, else the usual ones. `wanted`: it is a drive, which has objects.
export function useHomingMethods(device: string, wanted: boolean): readonly number[] {
  const path = objectsPath(device);
  const declared = useResource<Objects>(wanted ? path : null);
  const told = declared.data?.entries.some(({ index }) => Number.parseInt(index, 16) === kSupportedMethods) ?? false;
  const list = useResource<DeviceObject>(told ? `${path}/${axisIndex(kSupportedMethods, 0)}` : null);
  const methods = (list.data?.entries ?? [])
    .filter(({ subindex }) => Number.parseInt(subindex, 16) > 0)
    .flatMap(({ value }) => (typeof value === "number" && value !== 0 ? [value] : []));
  return methods.length > 0 ? methods : kUsualHomingMethods;
}

export function Homing({
  device,
  axis,
  title,
  methods,
  enabled,
  home,
}: {
  device: string;
  axis: number;
  title: string;
  methods: readonly number[];
  enabled: boolean;
  home: () => void;
}) {
  const { api } = useWorld();
  const { busy, error, run } = useAction();
  const place = `${objectsPath(device)}/${axisIndex(kMethod, axis)}/00`;
  const present = useResource<Entry>(place);
  const [chosen, setChosen] = useState<number | null>(null);
  const written = typeof present.data?.value === "number" ? present.data.value : 0;
  const method = chosen ?? (written === 0 ? (methods.includes(35) ? 35 : (methods[0] ?? 35)) : written);
  const go = async () => {
    if (method === written || (await run(() => api.send("PUT", place, { value: method })))) {
      present.reload();
      home();
    }
  };
  const listed = methods.includes(method) ? methods : [method, ...methods];
  return (
    <form
      class="homing"
      onSubmit={(event) => {
        event.preventDefault();
        void go();
      }}
    >
      <label class="field">
        <span>{t("Where home is")}</span>
        <select value={method} onChange={(event) => setChosen(Number(event.currentTarget.value))}>
          {listed.map((each) => (
            <option key={each} value={each}>
              {each} {homingMethodText(each)}
            </option>
          ))}
        </select>
      </label>
      <button type="submit" aria-label={t("Home {title}", { title })} disabled={!enabled || busy}>
        {t("Home")}
      </button>
      {kBySwitch.has(method) ? (
        <p class="soft">
          {tx("It turns until the switch is found: {link}, or press it by hand below, in the inputs.", {
            link: <a href={href("rack-file", [], { device, axis: String(axis) })}>{t("fit one in the rack file")}</a>,
          })}
        </p>
      ) : null}
      {error === "" ? null : (
        <p class="notice bad" role="alert">
          {error}
        </p>
      )}
    </form>
  );
}
