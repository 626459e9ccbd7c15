import { t } from "../language";
import { readTimes } from "./core/cursors";
import { frequencyText, numberText, timeText } from "./core/numbers";
import { NumberField } from "./number_field";
import type { Oscilloscope } from "./oscilloscope";
import type { Picture } from "./picture";

/// Two cursors in time (A, B), two in level (C, D).
export function CursorPanel({ scope, picture }: { scope: Oscilloscope; picture: Picture | null }) {
  const { times, levels } = scope.cursors;
  const keys = [...new Set(scope.setup.channels.filter(({ visible }) => visible).map((channel) => scope.axisKey(channel)))];
  const placeTimes = () => {
    const { from, to } = scope.shown();
    return { a: from + (to - from) / 3, b: from + ((to - from) * 2) / 3 };
  };
  const placeLevels = (key: string) => {
    const range = picture?.scales.find((scale) => scale.key === key)?.range ?? { from: 0, to: 1 };
    const span = range.to - range.from;
    return { key, a: range.from + span / 3, b: range.from + (span * 2) / 3 };
  };
  const reading = times === null ? null : readTimes(times);
  return (
    <div class="scope-form">
      <label class="check wide">
        <input
          type="checkbox"
          checked={times !== null}
          onChange={(event) => scope.setCursors({ times: event.currentTarget.checked ? placeTimes() : null })}
        />
        {t("Time cursors A and B")}
      </label>
      {times === null || reading === null ? null : (
        <>
          <NumberField
            label="A"
            unit="s"
            value={times.a * 1e-9}
            onValue={(a) => scope.setCursors({ times: { ...times, a: (a ?? 0) * 1e9 } })}
          />
          <NumberField
            label="B"
            unit="s"
            value={times.b * 1e-9}
            onValue={(b) => scope.setCursors({ times: { ...times, b: (b ?? 0) * 1e9 } })}
          />
          <p class="wide mono">
            B − A = {timeText(reading.difference)}, 1/|B − A| = {frequencyText(reading.frequency)}
          </p>
        </>
      )}
      <label class="check wide">
        <input
          type="checkbox"
          checked={levels !== null}
          disabled={keys.length === 0}
          onChange={(event) => scope.setCursors({ levels: event.currentTarget.checked ? placeLevels(keys[0]!) : null })}
        />
        {t("Level cursors C and D")}
      </label>
      {levels === null ? null : (
        <>
          <label class="field">
            <span>{t("Axis")}</span>
            <select value={levels.key} onChange={(event) => scope.setCursors({ levels: placeLevels(event.currentTarget.value) })}>
              {keys.map((key) => (
                <option key={key} value={key}>
                  {key === "" ? t("without unit") : key.replace(/^=/, "")}
                </option>
              ))}
            </select>
          </label>
          <NumberField label="C" value={levels.a} onValue={(a) => scope.setCursors({ levels: { ...levels, a: a ?? 0 } })} />
          <NumberField label="D" value={levels.b} onValue={(b) => scope.setCursors({ levels: { ...levels, b: b ?? 0 } })} />
          <p class="wide mono">D − C = {numberText(levels.b - levels.a)}</p>
        </>
      )}
      <p class="soft wide">{t("Drag them, or choose one in the picture with the keys A, B, C, D and move it with the arrows.")}</p>
    </div>
  );
}
