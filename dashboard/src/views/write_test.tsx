// What was done on the page, as a test to run again: the lines of a scenario, with what a person expects of it.
import { useEffect, useState } from "preact/hooks";

import type { Object as DeviceObject, RackFile, Signals } from "../api";
import { segment } from "../api";
import { CopyButton } from "../components/copy_button";
import { Guide } from "../components/guide";
import { unitText } from "../format";
import { useLive, useResource, useStore, useWorld } from "../hooks";
import type { Expectation, Journal } from "../journal";
import { t, tn, tx } from "../language";
import { numberOf } from "../motion_units";
import { href } from "../router";
import { saveFile } from "../save_file";
import { scenarioLines, settingKey, wantedSettings } from "../scenario_lines";
import "../styles/write_test.css";

const kFile = "my-test.toml";

/// What drives have been told before they moved, where it is not what they have by themselves.
function useSettings(journal: Journal): ReadonlyMap<string, number> {
  const { api } = useWorld();
  const [settings, setSettings] = useState<ReadonlyMap<string, number>>(new Map());
  const wanted = JSON.stringify(wantedSettings(journal.actions.value));
  useEffect(() => {
    let over = false;
    const ask = async () => {
      const found = new Map<string, number>();
      for (const { device, object } of JSON.parse(wanted) as ReturnType<typeof wantedSettings>) {
        const [index = "", subindex = ""] = object.split(":");
        try {
          const { entries } = await api.get<DeviceObject>(`/api/v1/devices/${segment(device)}/objects/${index}`);
          const entry = entries.find((each) => Number.parseInt(each.subindex, 16) === Number.parseInt(subindex, 16));
          if (typeof entry?.value === "number" && String(entry.value) !== entry.default) {
            found.set(settingKey(device, object), entry.value);
          }
        } catch {
          // A device without this object needs no such line.
        }
      }
      if (!over) {
        setSettings(found);
      }
    };
    void ask();
    return () => {
      over = true;
    };
  }, [api, wanted]);
  return settings;
}

export function WriteTestView() {
  const store = useStore();
  const { journal } = useWorld();
  const file = useResource<RackFile>(store.offers("/api/v1/rack/file") ? "/api/v1/rack/file" : null);
  const settings = useSettings(journal);
  const [name, setName] = useState("What I did by hand");
  const actions = journal.actions.value;
  const networks = store.rack?.networks ?? [];
  const text = scenarioLines(
    actions,
    {
      path: file.data?.path ?? "",
      devices: store.devices,
      kindOf: (network) => store.networkKind(network),
      segments: networks.filter(({ kind }) => kind === "ethercat").map((each) => each.name),
    },
    name,
    settings,
  );
  const expects = actions.some(({ kind }) => kind === "expectation");
  return (
    <>
      <div class="view-head">
        <h1>{t("Write a test")}</h1>
        <span class="soft">{t("What you do on this page becomes a test that runs without it, in CI for instance")}</span>
      </div>
      {actions.length === 0 ? (
        <section class="panel">
          <div class="body write-test-empty">
            <p>
              {tx("{strong} Do by hand what the test is to do, then come back:", {
                strong: <strong>{t("Nothing has been done here so far.")}</strong>,
              })}
            </p>
            <ul>
              <li>
                {t("on the page of a device take control and move an axis, or set an input:")}{" "}
                {store.devices.map((device, i) => (
                  <span key={device.name}>
                    {i > 0 ? ", " : ""}
                    <a href={href("device", [device.name])}>{device.name}</a>
                  </span>
                ))}
              </li>
              <li>{tx("put a fault, and clear it: {link}", { link: <a href={href("faults")}>{t("Faults")}</a> })}</li>
            </ul>
            <p class="soft">
              {t("Each of these becomes a step of the test. What another master does is not seen here; a recording keeps that.")}
            </p>
            <Guide path="how-to/scenarios.md" />
          </div>
        </section>
      ) : (
        <div class="two-columns">
          <section class="panel" aria-label={t("Lines of the test")}>
            <header>
              <h2>{t("Lines of the test")}</h2>
              <span class="soft">{tn(actions.length, "{count} thing done", "{count} things done")}</span>
              <span class="spacer" />
              <button type="button" onClick={() => journal.clear()}>
                {t("Begin anew")}
              </button>
            </header>
            <div class="body">
              <label class="field">
                <span>{t("What it shows")}</span>
                <input value={name} onInput={(event) => setName(event.currentTarget.value)} />
              </label>
            </div>
            <pre class="test-lines" tabIndex={0} role="region" aria-label={t("Scenario")}>
              {text}
            </pre>
          </section>
          <div class="stack">
            <Expect />
            <section class="panel" aria-label={t("Run the test")}>
              <header>
                <h2>{t("Run it")}</h2>
              </header>
              <div class="body">
                {expects ? null : (
                  <p class="notice warning">
                    {t("It expects nothing yet. A test that looks at nothing hardly fails: add what must be seen.")}
                  </p>
                )}
                <p>{tx("Download it, then in a terminal: {code}", { code: <code>stator test {kFile}</code> })}</p>
                <div class="toolbar">
                  <button type="button" class="primary" onClick={() => saveFile(kFile, new Blob([text], { type: "application/toml" }))}>
                    {t("Download {kFile}", { kFile })}
                  </button>
                  <CopyButton text={text} name={t("the lines of the test")} />
                </div>
                <p class="soft">
                  {t(
                    "It begins at power-on, in simulated time, with no master but its own: exit status 1 when something is not as expected. Pauses are as long as yours were; shorten them as you like.",
                  )}
                </p>
                <Guide path="how-to/scenarios.md" />
              </div>
            </section>
          </div>
        </div>
      )}
    </>
  );
}

const kComparisons: readonly [Expectation["comparison"], string][] = [
  ["equals", "is about"],
  ["above", "is above"],
  ["below", "is below"],
];

const kLeastMargin = 0.01; ///< about 0: nothing measured is exactly that

/// What must be seen after what was done last.
function Expect() {
  const { journal } = useWorld();
  const signals = useResource<Signals>("/api/v1/signals");
  const [signal, setSignal] = useState("");
  const known = signals.data?.signals.find((each) => each.name === signal);
  return (
    <section class="panel" aria-label={t("What must be seen")}>
      <header>
        <h2>{t("What must be seen then")}</h2>
      </header>
      <div class="body">
        <label class="field">
          <span>{t("Signal")}</span>
          <input
            value={signal}
            list="test-signals"
            placeholder={t("e.g. type “following”")}
            autocomplete="off"
            onInput={(event) => setSignal(event.currentTarget.value.trim())}
          />
          <datalist id="test-signals">
            {(signals.data?.signals ?? []).map((each) => (
              <option key={each.name} value={each.name} />
            ))}
          </datalist>
        </label>
        {known ? (
          <ExpectForm key={signal} signal={signal} unit={known.unit} done={(expectation) => journal.expect(expectation)} />
        ) : (
          <p class="soft">{signal === "" ? t("Choose a signal; its present value is proposed.") : t("The rack has no such signal.")}</p>
        )}
      </div>
    </section>
  );
}

function ExpectForm({ signal, unit, done }: { signal: string; unit: string; done: (expectation: Expectation) => void }) {
  const live = useLive(signal).value?.value ?? null;
  const [comparison, setComparison] = useState<Expectation["comparison"]>("equals");
  const [text, setText] = useState<string | null>(null);
  const [tolerance, setTolerance] = useState("");
  const [within, setWithin] = useState("2");
  const shown = text ?? (live === null ? "" : String(Number(live.toPrecision(4))));
  const value = numberOf(shown);
  const margin = tolerance === "" ? Math.abs(value ?? 0) * 0.05 || kLeastMargin : numberOf(tolerance);
  const seconds = numberOf(within);
  const good = value !== null && margin !== null && margin >= 0 && seconds !== null && seconds >= 0;
  return (
    <form
      class="expect"
      onSubmit={(event) => {
        event.preventDefault();
        if (good) {
          done({ signal, comparison, value, tolerance: Number(margin.toPrecision(3)), within: seconds });
        }
      }}
    >
      <label class="field">
        <span>{t("Must be so that it")}</span>
        <select value={comparison} onChange={(event) => setComparison(event.currentTarget.value as Expectation["comparison"])}>
          {kComparisons.map(([each, words]) => (
            <option key={each} value={each}>
              {words}
            </option>
          ))}
        </select>
      </label>
      <label class="field">
        <span>
          {t("Value")} <span class="soft">{unitText(unit)}</span>
        </span>
        <input inputMode="decimal" value={shown} aria-invalid={value === null} onInput={(event) => setText(event.currentTarget.value)} />
      </label>
      {comparison === "equals" ? (
        <label class="field">
          <span>
            {t("Give or take")} <span class="soft">{unitText(unit)}</span>
          </span>
          <input
            inputMode="decimal"
            value={tolerance}
            placeholder={margin === null ? "" : String(Number(margin.toPrecision(3)))}
            onInput={(event) => setTolerance(event.currentTarget.value)}
          />
        </label>
      ) : null}
      <label class="field">
        <span>
          {t("Within")} <span class="soft">s</span>
        </span>
        <input inputMode="decimal" value={within} onInput={(event) => setWithin(event.currentTarget.value)} />
      </label>
      <button type="submit" class="primary" disabled={!good}>
        {t("Add to the test")}
      </button>
    </form>
  );
}
