import { useState } from "preact/hooks";

import { segment, type Input, type Inputs } from "../api";
import { InputRow } from "../components/input_row";
import { unitText } from "../format";
import { useAction, useResource, useWorld } from "../hooks";
import { controlOf, differs, firstSpan } from "../inputs";
import { t, tx } from "../language";
import { numberOf } from "../motion_units";
import { href } from "../router";
import type { Place } from "./core/presets";

/// An input of the rack beside the picture of what it does; the load of the axis that is shown until another one is chosen.
export function InputsPanel({ place }: { place: Place | null }) {
  const { data, reload } = useResource<Inputs>("/api/v1/inputs", 3000);
  const [name, setName] = useState<string | null>(null);
  const inputs = data?.inputs ?? [];
  const load = place === null ? "" : `${place.device}.${place.axis}.load_torque`;
  const chosen = inputs.find((input) => input.name === (name ?? load));
  const own = inputs.filter((input) => place !== null && input.name.startsWith(`${place.device}.`));
  const others = inputs.filter((input) => !own.includes(input));
  const options = (some: readonly Input[]) =>
    some.map((input) => (
      <option key={input.name} value={input.name}>
        {input.name}
      </option>
    ));
  return (
    <div class="scope-inputs">
      <label class="field">
        <span>{t("Input")}</span>
        <select value={chosen?.name ?? ""} onChange={(event) => setName(event.currentTarget.value)}>
          <option value="">{t("none")}</option>
          {options(own)}
          {own.length > 0 && others.length > 0 ? <optgroup label={t("Other devices")}>{options(others)}</optgroup> : options(others)}
        </select>
      </label>
      {chosen === undefined ? null : (
        <>
          <InputRow key={chosen.name} input={chosen} label={chosen.name} present={chosen.value} onSet={reload} />
          {controlOf(chosen, firstSpan(chosen)).kind === "slider" ? (
            <StepForm key={`step ${chosen.name}`} input={chosen} reload={reload} />
          ) : null}
          {place !== null && chosen.name === load ? (
            <p class="soft">
              {tx("It shows while the axis holds or follows a position: {link}.", {
                link: <a href={href("device", [place.device])}>{t("move {device} by hand", { device: place.device })}</a>,
              })}
            </p>
          ) : null}
        </>
      )}
    </div>
  );
}

const kFirstTorque = "0.1"; ///< N m: large motors notice it and small ones hold against it

/// Sets an input from one moment to the next, and back: what a slider cannot.
function StepForm({ input, reload }: { input: Input; reload: () => void }) {
  const { api } = useWorld();
  const { busy, error, run } = useAction();
  const [text, setText] = useState(input.unit === "Nm" ? kFirstTorque : "");
  const value = numberOf(text);
  const stepped = differs(input);
  const set = async (next: number) => {
    await run(() => api.send("PUT", `/api/v1/inputs/${segment(input.name)}`, { value: next }));
    reload();
  };
  return (
    <form
      class="toolbar"
      onSubmit={(event) => {
        event.preventDefault();
        if (stepped) {
          void set(input.normal);
        } else if (value !== null) {
          void set(value);
        }
      }}
    >
      <label class="field">
        <span>
          {t("Step to")} <span class="soft">{unitText(input.unit)}</span>
        </span>
        <input inputMode="decimal" value={text} aria-invalid={value === null} onInput={(event) => setText(event.currentTarget.value)} />
      </label>
      <button type="submit" class="primary" disabled={busy || (!stepped && value === null)}>
        {stepped ? t("Step back to {value}", { value: `${input.normal} ${unitText(input.unit)}`.trim() }) : t("Step")}
      </button>
      {error === "" ? null : (
        <p class="notice bad" role="alert">
          {error}
        </p>
      )}
    </form>
  );
}
