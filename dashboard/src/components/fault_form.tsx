// The form by which a fault of one kind is put somewhere; in the view of faults, and where a fault would happen.
import { useMemo, useState } from "preact/hooks";

import type { FaultKind, FaultKinds, FaultParameter, Inputs, Signals, Wiring } from "../api";
import {
  defaultsOf,
  faultRequest,
  fieldOf,
  fieldProblem,
  filledIn,
  rangeText,
  targetAt,
  targetsOf,
  type Target,
  type TargetKeys,
  type Values,
} from "../fault_form";
import { unitText } from "../format";
import { useAction, useResource, useStore, useWorld } from "../hooks";
import { boardsOf } from "../inputs";
import { t } from "../language";
import { shaftsOf } from "../shafts";

function Parameter({
  parameter,
  value,
  group,
  change,
}: {
  parameter: FaultParameter;
  value: string;
  group: string;
  change: (text: string) => void;
}) {
  const field = fieldOf(parameter);
  const wrong = fieldProblem(parameter, value);
  const id = `${group}-${parameter.name}`;
  const { choices } = parameter;
  const missing = parameter.needed && value.trim() === "";
  return (
    <div class="field">
      <label htmlFor={id}>
        {parameter.name.replace(/_/g, " ")}{" "}
        {parameter.unit && field !== "text" ? <span class="soft">{t("in {unit}", { unit: unitText(parameter.unit) })}</span> : null}
      </label>
      {choices.length > 0 ? (
        <select id={id} value={value} aria-describedby={`${id}-help`} onChange={(event) => change(event.currentTarget.value)}>
          {choices.includes(value) ? null : <option value={value}>{value}</option>}
          {choices.map((choice) => (
            <option key={choice}>{choice}</option>
          ))}
        </select>
      ) : (
        <input
          id={id}
          value={value}
          placeholder={parameter.type === "duration" ? t("e.g. 20ms") : ""}
          aria-invalid={wrong !== "" && !missing}
          aria-required={parameter.needed}
          aria-describedby={`${id}-help`}
          onInput={(event) => change(event.currentTarget.value)}
        />
      )}
      <span id={`${id}-help`} class={wrong === "" || missing ? "soft help" : "help wrong"}>
        {wrong !== "" && !missing
          ? wrong
          : [missing ? t("needed") : "", parameter.summary, rangeText(parameter)].filter(Boolean).join("; ")}
      </span>
    </div>
  );
}

/// Values of a group of fields; `given` are those that differ from the defaults at first.
function useFields(parameters: readonly FaultParameter[], group: string, given: Values = {}) {
  const [values, setValues] = useState<Values>(() => ({ ...defaultsOf(parameters), ...given }));
  const fields = parameters.map((parameter) => (
    <Parameter
      key={parameter.name}
      parameter={parameter}
      group={group}
      value={values[parameter.name] ?? ""}
      change={(text) => setValues((old) => ({ ...old, [parameter.name]: text }))}
    />
  ));
  return {
    fields,
    wrong: parameters.some((parameter) => fieldProblem(parameter, values[parameter.name] ?? "") !== ""),
    keys: () => filledIn(parameters, values),
    reset: () => setValues(defaultsOf(parameters)),
  };
}

/// What a fault of a kind can be put on in this rack.
function useTargets(kind: FaultKind): Target[] {
  const store = useStore();
  const signals = useResource<Signals>(kind.applies_to === "axis" ? "/api/v1/signals" : null);
  const wiring = useResource<Wiring>(store.offers("/api/v1/wiring") ? "/api/v1/wiring" : null);
  const inputs = useResource<Inputs>(kind.applies_to === "axis" ? "/api/v1/inputs" : null);
  const devices = store.devices.map((device) => device.name);
  return useMemo(
    () =>
      targetsOf(kind.applies_to, {
        devices,
        axes: shaftsOf(signals.data?.signals ?? [], devices).map(({ device, name }) => ({ device, axis: name })),
        boards: boardsOf(inputs.data?.inputs ?? [], devices),
        wiring: wiring.data,
        networks: store.rack?.networks ?? [],
      }),
    [kind, signals.data, inputs.data, wiring.data, devices.join("\n")],
  );
}

/// `at` is where it is put unless somewhere else is chosen, `given` the values with which the form begins.
export function FaultForm({
  kind,
  kinds,
  at = {},
  given,
  done,
}: {
  kind: FaultKind;
  kinds: FaultKinds;
  at?: TargetKeys;
  given?: Values | undefined;
  done: () => void;
}) {
  const { api } = useWorld();
  const what = useFields(kind.parameters, "what", given);
  const milestone = useFields(kinds.when, "when");
  const [chosen, setChosen] = useState<number | null>(null);
  const { busy, error, run } = useAction();
  const targets = useTargets(kind);
  const place = chosen ?? targetAt(targets, at);
  const wrong = what.wrong || milestone.wrong;
  const target = targets[place];
  const put = async () => {
    if (target) {
      const body = faultRequest(kind, target.keys, what.keys(), milestone.keys());
      if (await run(() => api.send("POST", "/api/v1/faults", body))) {
        done();
      }
    }
  };
  return (
    <section class="panel">
      <header>
        <h2>{kind.name}</h2>
        <span class="soft">{kind.summary}</span>
      </header>
      <form
        class="body fault-form"
        onSubmit={(event) => {
          event.preventDefault();
          void put();
        }}
      >
        <p class="wide">{t("What the master sees: {effect}", { effect: kind.effect })}</p>
        <div class="field">
          <label htmlFor="fault-target">{t("where")}</label>
          <select id="fault-target" value={place} onChange={(event) => setChosen(Number(event.currentTarget.value))}>
            {targets.map((each, i) => (
              <option key={each.label} value={i}>
                {each.label}
              </option>
            ))}
          </select>
          <span class="soft help">
            {targets.length === 0
              ? t("the rack has no {applies_to}", { applies_to: kind.applies_to })
              : /^[aeiou]/.test(kind.applies_to)
                ? t("an {applies_to}", { applies_to: kind.applies_to })
                : t("a {applies_to}", { applies_to: kind.applies_to })}
          </span>
        </div>
        {what.fields}
        {milestone.fields.length > 0 ? (
          <details class="wide">
            <summary>{t("Begin at a milestone")}</summary>
            <div class="fault-form">{milestone.fields}</div>
          </details>
        ) : null}
        {error === "" ? null : (
          <p class="notice bad wide" role="alert">
            {error}
          </p>
        )}
        <div class="toolbar wide">
          <button type="submit" class="primary" disabled={busy || wrong || !target}>
            {t("Put it there")}
          </button>
          <button
            type="button"
            onClick={() => {
              what.reset();
              milestone.reset();
            }}
          >
            {t("Defaults")}
          </button>
        </div>
      </form>
    </section>
  );
}
