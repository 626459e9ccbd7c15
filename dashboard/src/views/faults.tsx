import { useMemo, useState } from "preact/hooks";

import type { Fault, FaultKind, FaultKinds, FaultParameter, Faults, Signals, Wiring } from "../api";
import { segment } from "../api";
import { defaultsOf, faultRequest, fieldOf, fieldProblem, filledIn, rangeText, targetsOf, type Values } from "../fault_form";
import { unitText } from "../format";
import { useAction, useResource, useStore, useWorld } from "../hooks";
import { useChoice } from "../router";
import { shaftsOf } from "../shafts";

export function FaultsView() {
  const kinds = useResource<FaultKinds>("/api/v1/faults/kinds");
  const active = useResource<Faults>("/api/v1/faults", 1000);
  const [name, setName] = useChoice("kind");
  const [words, setWords] = useChoice("search");
  const list = (kinds.data?.kinds ?? []).filter((kind) =>
    `${kind.name} ${kind.summary} ${kind.applies_to}`.toLowerCase().includes(words.toLowerCase()),
  );
  const kind = kinds.data?.kinds.find((each) => each.name === name) ?? null;
  return (
    <>
      <div class="view-head">
        <h1>Faults</h1>
        <span class="soft">Break something and see what the master does about it</span>
      </div>
      <div class="faults">
        <section class="panel">
          <header>
            <h2>Kinds</h2>
            <input
              type="search"
              class="fill"
              placeholder="Search"
              aria-label="Search kinds of faults"
              value={words}
              onInput={(event) => setWords(event.currentTarget.value)}
            />
          </header>
          <div class="scroller tall" role="region" aria-label="Kinds of faults">
            <ul class="choice">
              {list.map((each) => (
                <li key={each.name}>
                  <button type="button" aria-pressed={each.name === name} onClick={() => setName(each.name)}>
                    <strong>{each.name}</strong>
                    <span class="badge">{each.applies_to}</span>
                    <span class="soft">{each.summary}</span>
                  </button>
                </li>
              ))}
            </ul>
            {list.length === 0 ? <p class="empty">{kinds.error?.message ?? (kinds.data ? "None fits." : "…")}</p> : null}
          </div>
        </section>
        <div class="stack">
          {kind && kinds.data ? (
            <FaultForm key={kind.name} kind={kind} kinds={kinds.data} done={active.reload} />
          ) : (
            <section class="panel">
              <p class="empty">Choose a kind of fault.</p>
            </section>
          )}
          <ActiveFaults faults={active.data?.faults ?? []} reload={active.reload} />
        </div>
      </div>
    </>
  );
}

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
  const missing = wrong === "needed";
  return (
    <div class="field">
      <label htmlFor={id}>
        {parameter.name.replace(/_/g, " ")}{" "}
        {parameter.unit && field !== "text" ? <span class="soft">in {unitText(parameter.unit)}</span> : null}
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
          placeholder={parameter.type === "duration" ? "e.g. 20ms" : ""}
          aria-invalid={wrong !== "" && !missing}
          aria-required={parameter.needed}
          aria-describedby={`${id}-help`}
          onInput={(event) => change(event.currentTarget.value)}
        />
      )}
      <span id={`${id}-help`} class={wrong === "" || missing ? "soft help" : "help wrong"}>
        {wrong !== "" && !missing ? wrong : [missing ? "needed" : "", parameter.summary, rangeText(parameter)].filter(Boolean).join("; ")}
      </span>
    </div>
  );
}

/// Values of a group of fields.
function useFields(parameters: readonly FaultParameter[], group: string) {
  const [values, setValues] = useState<Values>(() => defaultsOf(parameters));
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

function FaultForm({ kind, kinds, done }: { kind: FaultKind; kinds: FaultKinds; done: () => void }) {
  const { api } = useWorld();
  const store = useStore();
  const what = useFields(kind.parameters, "what");
  const milestone = useFields(kinds.when, "when");
  const [chosen, setChosen] = useState(0);
  const { busy, error, run } = useAction();
  const signals = useResource<Signals>(kind.applies_to === "axis" ? "/api/v1/signals" : null);
  const wiring = useResource<Wiring>(store.offers("/api/v1/wiring") ? "/api/v1/wiring" : null);
  const devices = store.devices.map((device) => device.name);
  const targets = useMemo(
    () =>
      targetsOf(kind.applies_to, {
        devices,
        axes: shaftsOf(signals.data?.signals ?? [], devices).map(({ device, name }) => ({ device, axis: name })),
        wiring: wiring.data,
        networks: store.rack?.networks ?? [],
      }),
    [kind, signals.data, wiring.data, devices.join("\n")],
  );
  const wrong = what.wrong || milestone.wrong;
  const target = targets[Math.min(chosen, targets.length - 1)];
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
        <p class="wide">What the master sees: {kind.effect}</p>
        <div class="field">
          <label htmlFor="fault-target">where</label>
          <select id="fault-target" value={chosen} onChange={(event) => setChosen(Number(event.currentTarget.value))}>
            {targets.map((each, i) => (
              <option key={each.label} value={i}>
                {each.label}
              </option>
            ))}
          </select>
          <span class="soft help">{targets.length === 0 ? `the rack has no ${kind.applies_to}` : `a ${kind.applies_to}`}</span>
        </div>
        {what.fields}
        {milestone.fields.length > 0 ? (
          <details class="wide">
            <summary>Begin at a milestone</summary>
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
            Put it there
          </button>
          <button
            type="button"
            onClick={() => {
              what.reset();
              milestone.reset();
            }}
          >
            Defaults
          </button>
        </div>
      </form>
    </section>
  );
}

const kStates: Readonly<Record<string, string>> = { armed: "warning", active: "bad", done: "" };

function ActiveFaults({ faults, reload }: { faults: readonly Fault[]; reload: () => void }) {
  const { api } = useWorld();
  const { busy, error, run } = useAction();
  const standing = faults.some((fault) => fault.state !== "done");
  const remove = async (path: string) => {
    await run(() => api.send("DELETE", path));
    reload();
  };
  return (
    <section class="panel">
      <header>
        <h2>In this rack</h2>
        <span class="spacer" />
        <button type="button" disabled={busy || !standing} onClick={() => void remove("/api/v1/faults")}>
          Clear all
        </button>
      </header>
      {error === "" ? null : <p class="notice bad">{error}</p>}
      {standing ? null : <p class="empty">No fault is armed or active.</p>}
      {faults.length === 0 ? null : (
        <table>
          <thead>
            <tr>
              <th class="number">No.</th>
              <th>Kind</th>
              <th>Where</th>
              <th>State</th>
              <th class="number">Hits</th>
              <th>Remaining</th>
              <th>
                <span class="hidden-text">Clear</span>
              </th>
            </tr>
          </thead>
          <tbody>
            {faults.map((fault) => (
              <tr key={fault.id}>
                <td class="number">{fault.id}</td>
                <td>
                  {fault.kind}
                  {fault.name ? <span class="soft"> {fault.name}</span> : null}
                </td>
                <td>{fault.target}</td>
                <td>
                  <span class={`badge ${kStates[fault.state] ?? ""}`}>{fault.state}</span>
                </td>
                <td class="number">{fault.hits}</td>
                <td>{fault.remaining}</td>
                <td class="number">
                  {fault.state === "done" ? null : (
                    <button
                      type="button"
                      disabled={busy}
                      aria-label={`Clear fault ${fault.id}`}
                      onClick={() => void remove(`/api/v1/faults/${segment(String(fault.id))}`)}
                    >
                      Clear
                    </button>
                  )}
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
    </section>
  );
}
