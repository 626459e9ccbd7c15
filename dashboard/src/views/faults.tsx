import { useRef } from "preact/hooks";

import type { Fault, FaultKinds, Faults } from "../api";
import { segment } from "../api";
import type { TargetKeys } from "../fault_form";
import { useAction, useResource, useStore, useWorld } from "../hooks";
import { t } from "../language";
import { href, useChoice, useQuery } from "../router";
import { FaultForm } from "../components/fault_form";

/// Where a link from another view asks for it.
function placeIn(query: ReadonlyMap<string, string>): TargetKeys {
  const device = query.get("device");
  const axis = query.get("axis");
  return { ...(device === undefined ? {} : { device }), ...(axis === undefined ? {} : { axis: Number(axis) }) };
}

export function FaultsView() {
  const kinds = useResource<FaultKinds>("/api/v1/faults/kinds");
  const active = useResource<Faults>("/api/v1/faults", 1000);
  const [name, setName] = useChoice("kind");
  const [words, setWords] = useChoice("search");
  const shown = useRef("");
  const list = (kinds.data?.kinds ?? []).filter((kind) =>
    `${kind.name} ${kind.summary} ${kind.applies_to}`.toLowerCase().includes(words.toLowerCase()),
  );
  const [query] = useQuery();
  const at = placeIn(query);
  const kind = kinds.data?.kinds.find((each) => each.name === name) ?? null;
  return (
    <>
      <div class="view-head">
        <h1>{t("Faults")}</h1>
        <span class="soft">{t("Break something and see what the master does about it")}</span>
      </div>
      <div class="faults">
        <section class="panel">
          <header>
            <h2>{t("Kinds")}</h2>
            <input
              type="search"
              class="fill"
              placeholder={t("Search")}
              aria-label={t("Search kinds of faults")}
              value={words}
              onInput={(event) => setWords(event.currentTarget.value)}
            />
          </header>
          <div class="scroller tall" role="region" aria-label={t("Kinds of faults")}>
            <ul class="choice">
              {list.map((each) => (
                <li key={each.name}>
                  <button
                    type="button"
                    ref={(element) => {
                      if (each.name === name && shown.current !== name) {
                        shown.current = name;
                        element?.scrollIntoView({ block: "nearest" });
                      }
                    }}
                    aria-pressed={each.name === name}
                    onClick={() => setName(each.name)}
                  >
                    <strong>{each.name}</strong>
                    <span class="badge">{each.applies_to}</span>
                    <span class="soft">{each.summary}</span>
                  </button>
                </li>
              ))}
            </ul>
            {list.length === 0 ? (
              <p class="empty">
                {kinds.error?.message ??
                  (kinds.data ? t("No kind of fault has these words. Try fewer, or others: stall, cable, voltage, delay.") : "…")}
              </p>
            ) : null}
          </div>
        </section>
        <div class="stack">
          {kind && kinds.data ? (
            <FaultForm key={kind.name} kind={kind} kinds={kinds.data} at={at} done={active.reload} />
          ) : (
            <section class="panel">
              <p class="empty">{t("Choose a kind of fault: then you say where, when and for how long.")}</p>
            </section>
          )}
          <ActiveFaults faults={active.data?.faults ?? []} reload={active.reload} />
        </div>
      </div>
    </>
  );
}

/// What it is put on, with the way to where its consequences show.
function Where({ target }: { target: string }) {
  const store = useStore();
  const device = store.devices
    .map(({ name }) => name)
    .find((name) => target === name || target.startsWith(`${name} `) || target.startsWith(`${name},`));
  if (device === undefined) {
    return <>{target}</>;
  }
  const axis = /axis ?(\d+)/.exec(target)?.[1];
  const at: Record<string, string> = axis === undefined ? {} : { axis: `axis${axis}` };
  return (
    <>
      {target}
      <span class="leads">
        <a href={href("device", [device], at)}>{t("Look at {device}", { device })}</a>
        {axis === undefined ? null : <a href={href("scope", [], { device, ...at })}>{t("Watch it in the oscilloscope")}</a>}
        <a href={href("events", [], { device })}>{t("Events of {device}", { device })}</a>
      </span>
    </>
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
        <h2>{t("In this rack")}</h2>
        <span class="spacer" />
        <button type="button" disabled={busy || !standing} onClick={() => void remove("/api/v1/faults")}>
          {t("Clear all")}
        </button>
      </header>
      {error === "" ? null : <p class="notice bad">{error}</p>}
      {standing ? null : <p class="empty">{t("No fault is armed or active. Choose a kind, or try one from the page of a device.")}</p>}
      {faults.length === 0 ? null : (
        <div class="scroller">
          <table>
            <thead>
              <tr>
                <th class="number">{t("No.")}</th>
                <th>{t("Kind")}</th>
                <th>{t("Where")}</th>
                <th>{t("State")}</th>
                <th class="number">{t("Hits")}</th>
                <th>{t("Remaining")}</th>
                <th>
                  <span class="hidden-text">{t("Clear")}</span>
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
                  <td>{fault.state === "done" ? fault.target : <Where target={fault.target} />}</td>
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
                        aria-label={t("Clear fault {id}", { id: fault.id })}
                        onClick={() => void remove(`/api/v1/faults/${segment(String(fault.id))}`)}
                      >
                        {t("Clear")}
                      </button>
                    )}
                  </td>
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      )}
    </section>
  );
}
