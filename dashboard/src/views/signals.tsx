import { segment, type Device, type Signals } from "../api";
import { quantity } from "../format";
import { useResource, useShownIn, useSignals, useStore } from "../hooks";
import { t, tn, tx } from "../language";
import { href, useChoice } from "../router";

/// All signals of a device as numbers.
export function DeviceSignals({ device }: { device: Device }) {
  const store = useStore();
  const list = useResource<Signals>(`/api/v1/signals?names=${segment(device.name)}.*`);
  const [words, setWords] = useChoice("search");
  const inUnit = useShownIn();
  const shown = (list.data?.signals ?? []).filter(({ name }) => name.toLowerCase().includes(words.toLowerCase()));
  const value = useSignals(
    shown.map((signal) => signal.name),
    200,
  );
  return (
    <section class="panel">
      <header class="toolbar">
        <input
          type="search"
          placeholder={t("Search")}
          aria-label={t("Search signals")}
          value={words}
          onInput={(event) => setWords(event.currentTarget.value)}
        />
        <span class="spacer" />
        <span class="soft">
          {tn(shown.length, "{count} signal", "{count} signals")}
          {store.offers("/api/v1/signals") ? (
            <>
              {" – "}
              <a href={href("scope", [], { device: device.name })}>{t("plot them in the oscilloscope")}</a>
            </>
          ) : null}
        </span>
      </header>
      <ul class="signal-list">
        {shown.map((signal) => {
          const live = inUnit(signal.name, value(signal.name) ?? signal);
          const text = quantity(live?.value, live?.unit ?? "");
          return (
            <li key={signal.name}>
              <span class="name" title={signal.name}>
                {signal.name.slice(device.name.length + 1)}
              </span>
              <span class="value">{text.value}</span>
              <span class="unit soft">{text.unit}</span>
            </li>
          );
        })}
      </ul>
      {shown.length > 0 ? null : list.data === null ? (
        <p class="empty">{list.error?.message ?? "…"}</p>
      ) : words === "" ? (
        <p class="empty">
          {tx("{name} has no signals. What it does on the wire is in {link}.", {
            name: device.name,
            link: <a href={href("traffic")}>{t("Traffic")}</a>,
          })}
        </p>
      ) : (
        <p class="empty">
          {t("None of the {signals} signals has “{words}” in its name.", { signals: list.data.signals.length, words })}{" "}
          <button type="button" onClick={() => setWords("")}>
            {t("Show all")}
          </button>
        </p>
      )}
    </section>
  );
}
