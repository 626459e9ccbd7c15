// "Try a fault" where it would happen: the form of the faults' view in a dialogue, with the place filled in.
import { useEffect, useRef, useState } from "preact/hooks";

import type { FaultKinds } from "../api";
import { fitsNetwork, type TargetKeys, type Values } from "../fault_form";
import { useResource, useStore } from "../hooks";
import { t } from "../language";
import { href } from "../router";
import { FaultForm } from "./fault_form";

/// What faults can be put on, as their kinds name it.
export type FaultPlace = "axis" | "device" | "port" | "bus" | "line";

interface Place {
  /// For people, e.g. "gantry, axis0".
  readonly name: string;
  readonly places: readonly FaultPlace[];
  readonly at: TargetKeys;
  /// Kind of the device's network: "ethercat", "can", or empty.
  readonly network: string;
  /// The kinds to choose from, each with the values with which it is meant; undefined: all that fit the place.
  readonly kinds?: ReadonlyMap<string, Values>;
  /// It is one of many: shown as a sign alone.
  readonly small?: boolean;
}

/// Left out where the server takes no faults.
export function TryFault(place: Place) {
  const store = useStore();
  const [open, setOpen] = useState(false);
  const [put, setPut] = useState(false);
  if (!store.offers("/api/v1/faults/kinds")) {
    return null;
  }
  const label = t("Try a fault at {name}", { name: place.name });
  return (
    <>
      <span role="status" class={place.small ? "hidden-text" : ""}>
        {put ? place.small ? t("Fault is put") : <a href={href("faults")}>{t("Fault is put")}</a> : null}
      </span>
      <button
        type="button"
        class={place.small ? "small sign" : "small"}
        aria-label={label}
        title={place.small ? label : undefined}
        onClick={() => setOpen(true)}
      >
        {place.small ? <FaultSign /> : t("Try a fault")}
      </button>
      {open ? (
        <FaultDialog
          {...place}
          close={(done) => {
            setOpen(false);
            setPut(done);
          }}
        />
      ) : null}
    </>
  );
}

function FaultSign() {
  return (
    <svg viewBox="0 0 12 12" width="12" height="12" aria-hidden="true">
      <path d="M7 0 2 7h3l-1 5 6-7H6.5z" fill="currentColor" />
    </svg>
  );
}

function FaultDialog({ name, places, at, network, kinds: offered, close }: Place & { close: (put: boolean) => void }) {
  const dialog = useRef<HTMLDialogElement>(null);
  const done = useRef(false);
  const [chosen, setChosen] = useState("");
  const kinds = useResource<FaultKinds>("/api/v1/faults/kinds");
  useEffect(() => dialog.current?.showModal(), []);
  const list = (kinds.data?.kinds ?? []).filter(
    (kind) => places.some((each) => each === kind.applies_to) && fitsNetwork(kind.name, network) && (offered?.has(kind.name) ?? true),
  );
  const kind = list.find((each) => each.name === chosen) ?? list[0];
  return (
    <dialog ref={dialog} class="try-fault" onClose={() => close(done.current)} aria-labelledby="try-fault-title">
      <div class="toolbar">
        <h2 id="try-fault-title">{t("Try a fault at {name}", { name })}</h2>
        <span class="spacer" />
        <button type="button" onClick={() => dialog.current?.close()}>
          {t("Close")}
        </button>
      </div>
      {kind && kinds.data ? (
        <>
          <label class="field">
            <span>{t("What goes wrong")}</span>
            <select value={kind.name} onChange={(event) => setChosen(event.currentTarget.value)}>
              {list.map((each) => (
                <option key={each.name} value={each.name}>
                  {each.name}: {each.summary}
                </option>
              ))}
            </select>
          </label>
          <FaultForm
            key={kind.name}
            kind={kind}
            kinds={kinds.data}
            at={at}
            given={offered?.get(kind.name)}
            done={() => {
              done.current = true;
              dialog.current?.close();
            }}
          />
        </>
      ) : (
        <p class="empty">{kinds.error?.message ?? "…"}</p>
      )}
    </dialog>
  );
}
