import { useState } from "preact/hooks";

interface Properties {
  readonly label: string;
  readonly value: number | null;
  /// Null: the field was emptied, which is refused unless `optional`.
  readonly onValue: (value: number | null) => void;
  readonly optional?: boolean;
  readonly hideLabel?: boolean;
  readonly minimum?: number;
  readonly placeholder?: string;
  readonly unit?: string;
}

/// A number that counts when it is complete: with Enter or when the field is left.
export function NumberField({ label, value, onValue, optional, hideLabel, minimum = -Infinity, placeholder, unit }: Properties) {
  const [text, setText] = useState<string | null>(null);
  const parsed = text === null ? value : text.trim() === "" ? null : Number(text);
  const valid = parsed === null ? optional === true || text === null : Number.isFinite(parsed) && parsed >= minimum;
  const finish = () => {
    if (text !== null && valid && parsed !== value) {
      onValue(parsed);
    }
    setText(null);
  };
  return (
    <label class="field">
      <span class={hideLabel ? "hidden-text" : ""}>{label}</span>
      <span class="with-unit">
        <input
          class="number"
          aria-label={label}
          inputMode="decimal"
          value={text ?? (value === null ? "" : String(Number(value.toPrecision(9))))}
          aria-invalid={!valid}
          placeholder={placeholder}
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
        {unit ? <span class="soft">{unit}</span> : null}
      </span>
    </label>
  );
}
