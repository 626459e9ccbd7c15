import { useMemo, useState } from "preact/hooks";

import type { Event } from "../api";
import { timeText } from "../format";
import { useStore } from "../hooks";
import { t, tx } from "../language";
import { href, useQuery } from "../router";
import { EventExplanation } from "./event_explanation";

const kMostShown = 500;

const kKinds: Readonly<Record<string, string>> = {
  information: "",
  refusal: "warning",
  warning: "warning",
  fault: "bad",
};

/// What the number beside "Events" counts.
const kBad = "refusal fault";

export function severityClass(severity: string): string {
  return `badge ${kKinds[severity] ?? ""}`;
}

export function matchingEvents(events: readonly Event[], wanted: { text: string; device: string; severity: string }): Event[] {
  const words = wanted.text.toLowerCase().split(/\s+/).filter(Boolean);
  return events.filter(
    (event) =>
      (wanted.device === "" || event.device === wanted.device) &&
      (wanted.severity === "" || wanted.severity.split(" ").includes(event.severity)) &&
      words.every((word) => `${event.device} ${event.rule} ${event.text}`.toLowerCase().includes(word)),
  );
}

export function EventRows({ events, short = false }: { events: readonly Event[]; short?: boolean }) {
  return (
    <table class="events">
      <thead>
        <tr>
          <th class="number time">{t("Time")}</th>
          <th class="severity">{t("Kind")}</th>
          {short ? null : <th class="device">{t("Device")}</th>}
          <th>{t("What happened")}</th>
        </tr>
      </thead>
      <tbody>
        {events.map((event) => (
          <tr key={event.number}>
            <td class="number time">{timeText(event.time_ns)}</td>
            <td class="severity">
              <span class={severityClass(event.severity)}>{event.severity}</span>
            </td>
            {short ? null : <td class="device">{event.device}</td>}
            <td class="sentence" title={event.rule}>
              <EventSentence event={event} />
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/// `place` tells it from the same event elsewhere on the page.
export function EventSentence({ event, place = "event" }: { event: Event; place?: string }) {
  const [open, setOpen] = useState(false);
  const id = `${place}-${event.number}`;
  return (
    <>
      {event.text}{" "}
      <button
        type="button"
        class="why"
        aria-expanded={open}
        aria-controls={open ? id : undefined}
        aria-label={t("Explain {place} {number}", { place, number: event.number })}
        onClick={() => setOpen(!open)}
      >
        {open ? t("Less") : t("Explain")}
      </button>
      {open ? <EventExplanation event={event} id={id} /> : null}
    </>
  );
}

export function EventsView() {
  const { events, devices } = useStore();
  const [query, change] = useQuery();
  const text = query.get("search") ?? "";
  const device = query.get("device") ?? "";
  const severity = query.get("kind") ?? "";
  const [frozen, setFrozen] = useState<readonly Event[] | null>(null);
  const shown = useMemo(
    () =>
      matchingEvents(frozen ?? events, { text, device, severity })
        .slice(-kMostShown)
        .reverse(),
    [frozen, events, text, device, severity],
  );
  return (
    <>
      <div class="view-head">
        <h1>{t("Events")}</h1>
        <span class="soft">{t("Why something was refused, and what else happened; the newest first")}</span>
      </div>
      <section class="panel">
        <header class="toolbar">
          <input
            type="search"
            placeholder={t("Words to find")}
            aria-label={t("Words to find")}
            value={text}
            onInput={(event) => change({ search: event.currentTarget.value })}
          />
          <select aria-label={t("Device")} value={device} onChange={(event) => change({ device: event.currentTarget.value })}>
            <option value="">{t("All devices")}</option>
            {devices.map((each) => (
              <option key={each.name}>{each.name}</option>
            ))}
          </select>
          <select aria-label={t("Kind")} value={severity} onChange={(event) => change({ kind: event.currentTarget.value })}>
            <option value="">{t("All kinds")}</option>
            <option value={kBad}>{t("refusal or fault")}</option>
            {Object.keys(kKinds).map((kind) => (
              <option key={kind}>{kind}</option>
            ))}
          </select>
          <button type="button" aria-pressed={frozen !== null} onClick={() => setFrozen(frozen ? null : events)}>
            {t("Pause")}
          </button>
          <span class="spacer" />
          <span class="soft">{t("{shown} of {events}", { shown: shown.length, events: events.length })}</span>
        </header>
        <div class="scroller tall" tabIndex={0} role="region" aria-label={t("List of events")}>
          {shown.length > 0 ? (
            <EventRows events={shown} />
          ) : (
            <p class="empty">
              {events.length > 0 ? (
                <>
                  {t("No event fits the filter.")}{" "}
                  <button type="button" onClick={() => change({ search: "", device: "", kind: "" })}>
                    {t("Show all")}
                  </button>
                </>
              ) : (
                <>
                  {tx(
                    "Nothing has happened so far. {link}, take a device by hand on its page, or {link2}: what devices refuse and why is told here.",
                    { link: <a href={href("rack")}>{t("Connect a master")}</a>, link2: <a href={href("faults")}>{t("put a fault")}</a> },
                  )}
                </>
              )}
            </p>
          )}
        </div>
      </section>
    </>
  );
}
