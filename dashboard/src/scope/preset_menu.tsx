import { t } from "../language";
import { type Choosing, type Place } from "./core/presets";
import type { Shown } from "./use_shown";

const kOwn = "own";

function placeName({ device, axis }: Place): string {
  return axis === "" ? device : `${device} ${axis}`;
}

/// What is looked at, and of which device.
export function PresetMenu({ offered, shown }: { offered: readonly Choosing[]; shown: Shown }) {
  const first = offered[0];
  if (first === undefined) {
    return null;
  }
  const { choosing, choose, recall } = shown;
  const places = [...new Set(offered.map(({ place }) => place))];
  const present = shown.place ?? first.place;
  const presets = offered.filter(({ place }) => place === present);
  /// The same preset there, or the first one that it has.
  const goTo = (place: Place) => {
    const there = offered.filter((each) => each.place === place);
    choose(there.find(({ preset }) => preset === choosing?.preset) ?? there[0]!);
  };
  return (
    <div class="toolbar scope-presets" role="toolbar" aria-label={t("What to look at")}>
      <label>
        {t("Show")}{" "}
        <select
          aria-label={t("Preset")}
          value={choosing?.preset.key ?? kOwn}
          onChange={(event) => {
            const key = event.currentTarget.value;
            const wanted = presets.find(({ preset }) => preset.key === key);
            if (wanted !== undefined) {
              choose(wanted);
            } else {
              recall?.();
            }
          }}
        >
          {choosing === null || recall !== null ? <option value={kOwn}>{t("own setup")}</option> : null}
          {presets.map(({ preset }) => (
            <option key={preset.key} value={preset.key} title={preset.summary}>
              {preset.name}
            </option>
          ))}
        </select>
      </label>
      <label>
        {t("of")}{" "}
        <select
          aria-label={t("Device")}
          value={String(places.indexOf(present))}
          onChange={(event) => goTo(places[Number(event.currentTarget.value)]!)}
        >
          {places.map((place, i) => (
            <option key={placeName(place)} value={String(i)}>
              {placeName(place)}
            </option>
          ))}
        </select>
      </label>
      <span class="soft">{choosing?.preset.summary ?? t("A setup of your own. Choose what else to look at here.")}</span>
    </div>
  );
}
