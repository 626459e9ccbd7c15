import { useState } from "preact/hooks";

import { unitText } from "../format";
import { t } from "../language";
import { frequencyText, numberText, timeText } from "./core/numbers";
import { kFunctions } from "./core/expression";
import { readChannel } from "./core/cursors";
import { NumberField } from "./number_field";
import type { Oscilloscope } from "./oscilloscope";
import { seriesColour } from "./picture";

type Attempt = (action: () => void) => void;

/// Channels with their scales and measurements.
export function ChannelTable({ scope, attempt }: { scope: Oscilloscope; attempt: Attempt }) {
  const { channels } = scope.setup;
  const { ring } = scope.record;
  const { times } = scope.cursors;
  if (channels.length === 0) {
    return <p class="empty">{t("Nothing is shown. Choose a preset above, or switch signals on in the list.")}</p>;
  }
  return (
    <div class="scroller">
      <table class="scope-channels">
        <thead>
          <tr>
            <th scope="col">{t("Channel")}</th>
            <th scope="col" class="number">
              {t("Value")}
            </th>
            <th scope="col" class="number">
              {t("Minimum")}
            </th>
            <th scope="col" class="number">
              {t("Maximum")}
            </th>
            <th scope="col" class="number">
              {t("Peak-peak")}
            </th>
            <th scope="col" class="number">
              {t("Mean")}
            </th>
            <th scope="col" class="number">
              RMS
            </th>
            <th scope="col" class="number">
              {t("Period")}
            </th>
            <th scope="col" class="number">
              {t("Frequency")}
            </th>
            {times === null ? null : (
              <>
                <th scope="col" class="number">
                  {t("at A")}
                </th>
                <th scope="col" class="number">
                  {t("at B")}
                </th>
                <th scope="col" class="number">
                  B − A
                </th>
                <th scope="col" class="number">
                  {t("Slope")}
                </th>
              </>
            )}
            <th scope="col">{t("Gain")}</th>
            <th scope="col">{t("Offset")}</th>
            <th scope="col">{t("Axis")}</th>
            <th scope="col">
              <span class="hidden-text">{t("Remove")}</span>
            </th>
          </tr>
        </thead>
        <tbody>
          {channels.map((channel, i) => {
            const measured = scope.measurements[i];
            const reading = times === null ? null : readChannel(ring, i, times);
            const { unit, factor } = scope.display(channel);
            const number = (value: number | undefined) => <td class="number mono">{numberText((value ?? NaN) * factor)}</td>;
            return (
              <tr key={channel.name} data-channel={channel.name}>
                <th scope="row">
                  <label class="check" title={channel.expression ?? undefined}>
                    <input
                      type="checkbox"
                      checked={channel.visible}
                      onChange={(event) => attempt(() => scope.changeChannel(channel.name, { visible: event.currentTarget.checked }))}
                    />
                    <span class="swatch" style={{ background: seriesColour(i) }} />
                    <span>{channel.name}</span>
                    <span class="soft unit">{unitText(unit)}</span>
                  </label>
                </th>
                {number(ring.size > 0 ? ring.value(i, ring.end - 1) : NaN)}
                {number(measured?.minimum)}
                {number(measured?.maximum)}
                {number(measured?.peakToPeak)}
                {number(measured?.mean)}
                {number(measured?.rms)}
                <td class="number mono">{timeText(measured?.period ?? NaN)}</td>
                <td class="number mono">{frequencyText(measured?.frequency ?? NaN)}</td>
                {reading === null ? null : (
                  <>
                    {number(reading.a)}
                    {number(reading.b)}
                    {number(reading.difference)}
                    <td class="number mono">{numberText(reading.slope * factor)} /s</td>
                  </>
                )}
                <td>
                  <NumberField
                    label={t("Gain of {name}", { name: channel.name })}
                    hideLabel
                    value={channel.gain}
                    onValue={(gain) => attempt(() => scope.changeChannel(channel.name, { gain: gain ?? 1 }))}
                  />
                </td>
                <td>
                  <NumberField
                    label={t("Offset of {name}", { name: channel.name })}
                    hideLabel
                    value={channel.offset * factor}
                    onValue={(offset) => attempt(() => scope.changeChannel(channel.name, { offset: (offset ?? 0) / factor }))}
                  />
                </td>
                <td>
                  <select
                    aria-label={t("Axis of {name}", { name: channel.name })}
                    value={channel.own ? "own" : "unit"}
                    onChange={(event) => attempt(() => scope.changeChannel(channel.name, { own: event.currentTarget.value === "own" }))}
                  >
                    <option value="unit">{t("of its unit")}</option>
                    <option value="own">{t("its own")}</option>
                  </select>
                </td>
                <td>
                  <button
                    type="button"
                    aria-label={t("Remove {name}", { name: channel.name })}
                    title={t("Remove")}
                    onClick={() => attempt(() => scope.removeChannel(channel.name))}
                  >
                    ×
                  </button>
                </td>
              </tr>
            );
          })}
        </tbody>
      </table>
    </div>
  );
}

/// Scales that do not set themselves.
export function AxisTable({ scope, attempt }: { scope: Oscilloscope; attempt: Attempt }) {
  const keys = [...new Set(scope.setup.channels.map((channel) => scope.axisKey(channel)))];
  return (
    <ul class="scope-axes">
      {keys.map((key) => {
        const { range } = scope.axis(key);
        const name = key === "" ? t("without unit") : key.replace(/^=/, "");
        const set = (patch: { from?: number; to?: number }) => {
          const next = { from: 0, to: 1, ...range, ...patch };
          attempt(() => {
            if (!(next.from < next.to)) {
              throw new Error(t("The scale {name} must end above its begin, {from}", { name, from: next.from }));
            }
            scope.changeAxis(key, next);
          });
        };
        return (
          <li key={key}>
            <span class="name">{name}</span>
            <label class="check">
              <input
                type="checkbox"
                checked={range === null}
                onChange={(event) => attempt(() => scope.changeAxis(key, event.currentTarget.checked ? null : { from: -1, to: 1 }))}
              />
              {t("auto")}
            </label>
            {range === null ? null : (
              <>
                <NumberField
                  label={t("Lower end of {name}", { name })}
                  hideLabel
                  value={range.from}
                  onValue={(from) => set({ from: from ?? 0 })}
                />
                <NumberField label={t("Upper end of {name}", { name })} hideLabel value={range.to} onValue={(to) => set({ to: to ?? 1 })} />
              </>
            )}
          </li>
        );
      })}
    </ul>
  );
}

/// A channel that is calculated from others.
export function ExpressionForm({ scope }: { scope: Oscilloscope }) {
  const [name, setName] = useState("");
  const [expression, setExpression] = useState("");
  const [unit, setUnit] = useState("");
  const [error, setError] = useState("");
  const add = (event: Event) => {
    event.preventDefault();
    try {
      scope.addExpression(name, expression, unit);
      setName("");
      setExpression("");
      setUnit("");
      setError("");
    } catch (wrong) {
      setError((wrong as Error).message);
    }
  };
  return (
    <form class="scope-form" onSubmit={add}>
      <label class="field">
        <span>{t("Name")}</span>
        <input value={name} required onInput={(event) => setName(event.currentTarget.value)} />
      </label>
      <label class="field wide">
        <span>{t("Expression")}</span>
        <input
          class="mono"
          value={expression}
          required
          spellcheck={false}
          list="scope-channel-names"
          aria-invalid={error !== ""}
          aria-describedby="scope-expression-help"
          onInput={(event) => setExpression(event.currentTarget.value)}
        />
        <datalist id="scope-channel-names">
          {scope.setup.channels.map((channel) => (
            <option key={channel.name} value={channel.name} />
          ))}
        </datalist>
      </label>
      <label class="field">
        <span>{t("Unit")}</span>
        <input class="short" value={unit} placeholder={t("follows")} onInput={(event) => setUnit(event.currentTarget.value)} />
      </label>
      <button type="submit">{t("Add")}</button>
      {error === "" ? null : (
        <p class="notice bad wide" role="alert">
          {error}
        </p>
      )}
      <details id="scope-expression-help" class="wide soft">
        <summary>{t("How to write one")}</summary>
        <p>
          {t(
            "Channels by name, numbers, + − * / and parentheses; names with other characters than letters, digits, _ and . in double quotes. Functions:",
          )}
        </p>
        <ul>
          {Object.entries(kFunctions).map(([key, { summary }]) => (
            <li key={key}>
              <code>{key}</code> {summary}
            </li>
          ))}
        </ul>
      </details>
    </form>
  );
}
