import { useCallback, useEffect, useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";

import type { Api, Device, Signals } from "../api";
import { useConversion, useResource, useStore } from "../hooks";
import { t } from "../language";
import { AxisTable, ChannelTable, ExpressionForm } from "./channel_table";
import { Controls } from "./controls";
import { type Choosing, offeredOf, placesOf } from "./core/presets";
import type { Leaf } from "./core/tree";
import { CursorPanel } from "./cursor_panel";
import { type CsvRange, loadSetup, saveCsv, savePng, saveSetup } from "./files";
import { InputsPanel } from "./inputs_panel";
import { Oscilloscope } from "./oscilloscope";
import type { Picture } from "./picture";
import { Plot } from "./plot";
import { PresetMenu } from "./preset_menu";
import "./scope.css";
import { SignalTree } from "./signal_tree";
import { SpectrumPanel } from "./spectrum_panel";
import { TriggerPanel } from "./trigger_panel";
import { useScope } from "./use_scope";
import { useShown } from "./use_shown";

/// The oscilloscope. Shows what the address asks for, else what a person has set up here before, else the first preset there is.
export function Scope({ api, query }: { api: Api; query: ReadonlyMap<string, string> }) {
  const { devices } = useStore();
  const { data, error } = useResource<Signals>("/api/v1/signals");
  const [scope, setScope] = useState<Oscilloscope | null>(null);
  useLayoutEffect(() => {
    const made = new Oscilloscope(api);
    setScope(made);
    return () => made.close();
  }, [api]);
  const convert = useConversion();
  useEffect(() => scope?.showIn(convert), [scope, convert]);
  const signals = data?.signals ?? kNoSignals;
  const key = JSON.stringify(devices.map(({ name, network }) => ({ name, network })));
  const offered = useMemo(() => offeredOf(placesOf(JSON.parse(key) as Device[], signals), signals), [key, signals]);
  if (scope === null || (data === null && error === null)) {
    return null;
  }
  return <Instrument scope={scope} signals={signals} offered={offered} query={query} failure={error?.message ?? ""} />;
}

const kNoSignals: readonly Leaf[] = [];

interface InstrumentProperties {
  readonly scope: Oscilloscope;
  readonly signals: readonly Leaf[];
  readonly offered: readonly Choosing[];
  readonly query: ReadonlyMap<string, string>;
  /// Why there are no signals.
  readonly failure: string;
}

function Instrument({ scope, signals, offered, query, failure }: InstrumentProperties) {
  useScope(scope);
  const [picture, setPicture] = useState<Picture | null>(null);
  const [wrong, setWrong] = useState(failure);
  const attempt = useCallback((action: () => void) => {
    try {
      action();
      setWrong("");
    } catch (error) {
      setWrong((error as Error).message);
    }
  }, []);
  const shown = useShown({ scope, signals, offered, query, setWrong });
  const { setup } = scope;
  const problem = wrong || scope.problem;
  const side = useMemo(() => <SignalTree scope={scope} signals={signals} attempt={attempt} />, [scope, signals, attempt, setup.channels]);
  return (
    <div class="scope">
      <h1 class="hidden-text">{t("Oscilloscope")}</h1>
      <PresetMenu offered={offered} shown={shown} />
      <Controls scope={scope} attempt={attempt} />
      {problem === "" ? null : (
        <p class="notice bad" role="alert">
          {problem}{" "}
          <button
            type="button"
            onClick={() => {
              setWrong("");
              scope.problem = "";
            }}
          >
            {t("Dismiss")}
          </button>
        </p>
      )}
      <div class="scope-body">
        {side}
        <div class="scope-centre">
          <section class="panel" aria-label={t("Picture")}>
            <ViewBar scope={scope} picture={picture} attempt={attempt} />
            <Plot scope={scope} onPicture={setPicture} />
          </section>
          {setup.spectrum.shown && picture !== null ? <SpectrumPanel scope={scope} picture={picture} attempt={attempt} /> : null}
        </div>
        <div class="scope-side">
          <Section title={t("Set an input")} open>
            <InputsPanel place={shown.place} />
          </Section>
          <Section title={t("Trigger")} open>
            <TriggerPanel scope={scope} attempt={attempt} />
          </Section>
          <Section title={t("Cursors")} open>
            <CursorPanel scope={scope} picture={picture} />
          </Section>
          <Section title={t("Calculated channel")}>
            <ExpressionForm scope={scope} />
          </Section>
          <Section title={t("Scales")}>
            <AxisTable scope={scope} attempt={attempt} />
          </Section>
        </div>
        <section class="panel scope-table" aria-label={t("Channels and measurements")}>
          <ChannelTable scope={scope} attempt={attempt} />
        </section>
      </div>
    </div>
  );
}

function Section({ title, open, children }: { title: string; open?: boolean; children: preact.ComponentChildren }) {
  return (
    <details class="panel" open={open}>
      <summary>
        <h2>{title}</h2>
      </summary>
      <div class="body">{children}</div>
    </details>
  );
}

/// Zoom and files.
function ViewBar({ scope, picture, attempt }: { scope: Oscilloscope; picture: Picture | null; attempt: (action: () => void) => void }) {
  const [range, setRange] = useState<CsvRange>("shown");
  const [si, setSi] = useState(true);
  const file = useRef<HTMLInputElement>(null);
  const middle = () => {
    const { from, to } = scope.shown();
    return (from + to) / 2;
  };
  return (
    <header>
      <button
        type="button"
        aria-pressed={scope.held === null}
        onClick={() => scope.follow()}
        title={t("Show what is being recorded (Home, double click)")}
      >
        {t("Follow")}
      </button>
      <button type="button" aria-label={t("Zoom in")} title={t("Zoom in (+, wheel)")} onClick={() => scope.zoom(0.5, middle())}>
        +
      </button>
      <button type="button" aria-label={t("Zoom out")} title={t("Zoom out (−, wheel)")} onClick={() => scope.zoom(2, middle())}>
        −
      </button>
      <button type="button" aria-label={t("Earlier")} title={t("Earlier (arrow left, drag)")} onClick={() => scope.pan(-0.5)}>
        ‹
      </button>
      <button type="button" aria-label={t("Later")} title={t("Later (arrow right, drag)")} onClick={() => scope.pan(0.5)}>
        ›
      </button>
      <button
        type="button"
        disabled={scope.record.ring.size === 0}
        onClick={() => scope.hold({ from: scope.record.ring.oldest, to: scope.record.ring.newest })}
      >
        {t("All")}
      </button>
      <span class="spacer" />
      <label>
        <span class="hidden-text">{t("Rows to export")}</span>
        <select value={range} onChange={(event) => setRange(event.currentTarget.value as CsvRange)}>
          <option value="shown">{t("what is shown")}</option>
          <option value="cursors" disabled={scope.cursors.times === null}>
            {t("between A and B")}
          </option>
          <option value="all">{t("all that is recorded")}</option>
        </select>
      </label>
      <label class="check" title={t("Angles in rad, currents in A, temperatures in K …; microsteps and counts stay")}>
        <input type="checkbox" checked={si} onChange={(event) => setSi(event.currentTarget.checked)} />
        {t("SI units")}
      </label>
      <button type="button" title={t("As CSV, for a spreadsheet or a program")} onClick={() => saveCsv(scope, range, si)}>
        {t("Save values")}
      </button>
      <button
        type="button"
        title={t("As PNG, with the names of the channels")}
        disabled={picture === null}
        onClick={() => picture && savePng(scope, picture.canvas, picture.colours.series, picture.colours.text, picture.colours.surface)}
      >
        {t("Save picture")}
      </button>
      <button type="button" title={t("Channels, scales, time base and trigger, to load them again")} onClick={() => saveSetup(scope)}>
        {t("Save setup")}
      </button>
      <button type="button" onClick={() => file.current?.click()}>
        {t("Load setup")}
      </button>
      <input
        ref={file}
        type="file"
        accept="application/json,.json"
        class="hidden-text"
        tabIndex={-1}
        aria-label={t("Setup file")}
        onChange={(event) => {
          const chosen = event.currentTarget.files?.[0];
          event.currentTarget.value = "";
          if (chosen) {
            loadSetup(scope, chosen).then(
              () => attempt(() => undefined),
              (error: unknown) =>
                attempt(() => {
                  throw error;
                }),
            );
          }
        }}
      />
    </header>
  );
}
