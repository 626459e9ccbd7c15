import type { ComponentChildren } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";

import { segment, type Input } from "../api";
import { kNone, unitText } from "../format";
import { useAction, useLive, useWorld } from "../hooks";
import { controlOf, differs, firstSpan, labelOf, spansOf } from "../inputs";
import { t } from "../language";

const kAgain = 60; ///< ms between two writes of a slider that is being moved
const kSettled = 4000; ///< ms in which a value that was set comes back from the server, which is asked every 3 s

/// Something around a device that can be set. `present`: its value as far as the server tells. `onSet` is told of each
/// write that the server took. `children` stand at the end.
export function InputRow({
  input,
  label,
  present,
  onSet,
  children,
}: {
  input: Input;
  label: string;
  present: number | null;
  onSet?: (() => void) | undefined;
  children?: ComponentChildren;
}) {
  const { api } = useWorld();
  const { error, run, clear } = useAction();
  const [span, setSpan] = useState(() => firstSpan(input));
  const [own, setOwn] = useState<number | null>(null);
  const [text, setText] = useState<string | null>(null);
  const waiting = useRef<{ timer: ReturnType<typeof setTimeout> | undefined; next: number | null }>({
    timer: undefined,
    next: null,
  });
  const set = (value: number) => {
    setOwn(value);
    const state = waiting.current;
    state.next = value;
    if (state.timer === undefined) {
      const send = () => {
        const next = state.next;
        state.next = null;
        state.timer = undefined;
        if (next !== null) {
          state.timer = setTimeout(send, kAgain);
          void run(() => api.send("PUT", `/api/v1/inputs/${segment(input.name)}`, { value: next })).then((done) => {
            if (done) {
              onSet?.();
            } else {
              setOwn(null);
            }
          });
        }
      };
      send();
    }
  };
  useEffect(() => () => clearTimeout(waiting.current.timer), []);
  // What was set here stands until the server tells the same, or has had time to tell something else,
  // as when a fault holds the input.
  useEffect(() => {
    if (own === null || present === null) {
      return undefined;
    }
    if (present === own) {
      setOwn(null);
      return undefined;
    }
    const timer = setTimeout(() => setOwn(null), kSettled);
    return () => clearTimeout(timer);
  }, [own, present === null, present === own]);
  const value = own ?? present;
  const control = controlOf(input, span);
  const id = `input-${input.name}`;
  const name = labelOf(label);
  const finish = () => {
    if (text !== null && text.trim() !== "" && Number.isFinite(Number(text))) {
      set(Number(text));
    }
    setText(null);
  };
  return (
    <div class={`input-row ${control.kind}${differs(input) ? " differs" : ""}`}>
      {control.kind === "switch" ? (
        <label class="check wide">
          <input
            type="checkbox"
            role="switch"
            checked={value !== null && value >= 0.5}
            onChange={(event) => set(event.currentTarget.checked ? 1 : 0)}
          />
          {name}
        </label>
      ) : control.kind === "choice" ? (
        <>
          <label htmlFor={id}>{name}</label>
          <select id={id} class="wide2" value={value ?? ""} onChange={(event) => set(Number(event.currentTarget.value))}>
            {value === null ? <option value="">{kNone}</option> : null}
            {control.values.map((each) => (
              <option key={each} value={each}>
                {each}
              </option>
            ))}
          </select>
        </>
      ) : (
        <>
          <label htmlFor={id}>{name}</label>
          <input
            id={id}
            type="range"
            class={value === null ? "unknown" : ""}
            min={control.minimum}
            max={control.maximum}
            step={control.step}
            value={value ?? 0}
            aria-valuetext={value === null ? t("unknown") : `${value} ${input.unit}`}
            title={`${input.minimum ?? ""} … ${input.maximum ?? ""} ${unitText(input.unit)}`}
            onInput={(event) => set(Number(event.currentTarget.value))}
          />
          <input
            class="exact"
            aria-label={t("{name}, exact", { name })}
            inputMode="decimal"
            value={text ?? (value === null ? "" : String(Number(value.toPrecision(6))))}
            placeholder={kNone}
            onInput={(event) => setText(event.currentTarget.value)}
            onBlur={finish}
            onKeyDown={(event) => {
              if (event.key === "Enter") {
                finish();
              } else if (event.key === "Escape") {
                setText(null);
              }
            }}
          />
          {spansOf(input).length > 1 ? (
            <select
              aria-label={t("{name}, range of the slider", { name })}
              class="span"
              value={span}
              onChange={(event) => setSpan(Number(event.currentTarget.value))}
            >
              {spansOf(input).map((each) => (
                <option key={each} value={each}>
                  ±{each} {unitText(input.unit)}
                </option>
              ))}
            </select>
          ) : (
            <span class="soft">{unitText(input.unit)}</span>
          )}
        </>
      )}
      {children}
      {error === "" ? null : (
        <p class="notice bad wide" role="alert">
          {error}{" "}
          <button type="button" onClick={clear}>
            {t("Dismiss")}
          </button>
        </p>
      )}
    </div>
  );
}

/// The same of an input that is a signal as well, which knows its value best.
export function LiveInputRow(row: { input: Input; label: string; onSet: () => void; children?: ComponentChildren }) {
  const live = useLive(row.input.name);
  return <InputRow {...row} present={live.value?.value ?? row.input.value} />;
}
