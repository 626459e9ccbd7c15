import { useEffect, useRef } from "preact/hooks";

import type { RackCheck } from "../api";
import { t, tn } from "../language";
import { lineBegin } from "./toml";

type Problem = RackCheck["errors"][number];

/// The file's text, and below it what the program says of it.
export function TextPane({
  text,
  good,
  errors,
  warnings,
  failure,
  shown,
  change,
}: {
  text: string;
  /// The program has nothing against it.
  good: boolean;
  errors: readonly Problem[];
  warnings: readonly string[];
  failure: string;
  /// Where the part begins that the form shows.
  shown: number;
  change: (text: string) => void;
}) {
  const area = useRef<HTMLTextAreaElement>(null);
  const goTo = (from: number, to: number, focus: boolean) => {
    const element = area.current;
    if (element) {
      const kLine = parseFloat(getComputedStyle(element).lineHeight);
      const lines = text.slice(0, from).split("\n").length;
      element.scrollTop = Math.max(0, (lines - 4) * kLine);
      if (focus) {
        element.focus();
        element.setSelectionRange(from, to);
      }
    }
  };
  useEffect(() => goTo(shown, shown, false), [shown]);
  return (
    <section class="panel rack-text" aria-label={t("Text of the rack file")}>
      <header>
        <h2>{t("Text")}</h2>
        <span class="spacer" />
        <span role="status">
          {errors.length > 0 ? (
            <span class="badge bad">{tn(errors.length, "{count} problem", "{count} problems")}</span>
          ) : good ? (
            <span class="badge good">{t("no problem")}</span>
          ) : null}
        </span>
      </header>
      <textarea
        ref={area}
        aria-label={t("Rack file in TOML")}
        spellcheck={false}
        value={text}
        onInput={(event) => change(event.currentTarget.value)}
      />
      {failure === "" ? null : <p class="notice warning">{failure}</p>}
      {errors.length === 0 ? null : (
        <ul class="problems" aria-label={t("Problems")}>
          {errors.map((error) => (
            <li key={`${error.line} ${error.column} ${error.message}`}>
              {error.line > 0 ? (
                <button
                  type="button"
                  class="small"
                  onClick={() => goTo(lineBegin(text, error.line), lineBegin(text, error.line + 1), true)}
                >
                  {t("Line {line}", { line: error.line })}
                </button>
              ) : null}
              <span>{error.message}</span>
            </li>
          ))}
        </ul>
      )}
      {warnings.map((warning) => (
        <p key={warning} class="notice warning">
          {warning}
        </p>
      ))}
    </section>
  );
}
