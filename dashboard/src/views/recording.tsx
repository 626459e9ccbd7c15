import { useState } from "preact/hooks";

import { segment } from "../api";
import { timeText } from "../format";
import { useAction, useResource, useStore, useWorld } from "../hooks";

/// What of an answer can be shown without knowing it.
function Facts({ data }: { data: Readonly<Record<string, unknown>> }) {
  return (
    <table>
      <tbody>
        {Object.entries(data)
          .filter(([, value]) => value !== null && typeof value !== "object")
          .map(([name, value]) => (
            <tr key={name}>
              <td class="soft">{name.replace(/_/g, " ")}</td>
              <td>{name.endsWith("_ns") && typeof value === "number" ? timeText(value) : String(value)}</td>
            </tr>
          ))}
      </tbody>
    </table>
  );
}

interface Snapshot {
  readonly name: string;
  readonly time_ns?: number;
}

export function RecordingView() {
  const store = useStore();
  const recording = useResource<Record<string, unknown>>("/api/v1/recording", 1000);
  return (
    <>
      <div class="view-head">
        <h1>Recording</h1>
      </div>
      <div class="two-columns">
        <section class="panel">
          <header>
            <h2>Recording of this run</h2>
          </header>
          {recording.data && recording.data["file"] === null ? (
            <p class="empty">
              Nothing is recorded. Start with <code>stator run … --record NAME.stator</code> to have snapshots.
            </p>
          ) : recording.data ? (
            <Facts data={recording.data} />
          ) : null}
          {recording.error ? <p class="empty">{recording.error.message}</p> : null}
        </section>
        {store.offers("/api/v1/snapshots") ? <Snapshots /> : null}
      </div>
    </>
  );
}

function Snapshots() {
  const { api } = useWorld();
  const [name, setName] = useState("");
  const { busy, error, run } = useAction();
  const list = useResource<{ snapshots: Snapshot[] }>("/api/v1/snapshots", 2000);
  const take = async () => {
    if (await run(() => api.send("POST", "/api/v1/snapshots", { name }))) {
      setName("");
      list.reload();
    }
  };
  return (
    <section class="panel">
      <header>
        <h2>Snapshots</h2>
      </header>
      <form
        class="body toolbar"
        onSubmit={(event) => {
          event.preventDefault();
          void take();
        }}
      >
        <label class="field">
          <span>Name</span>
          <input value={name} required pattern="[A-Za-z_\-][A-Za-z0-9_\-]*" onInput={(event) => setName(event.currentTarget.value)} />
        </label>
        <button type="submit" class="primary" disabled={busy || name === ""}>
          Keep the present state
        </button>
      </form>
      {error === "" ? null : <p class="notice bad">{error}</p>}
      {list.data && list.data.snapshots.length > 0 ? (
        <table>
          <tbody>
            {list.data.snapshots.map((each) => (
              <tr key={each.name}>
                <td>{each.name}</td>
                <td class="number">{each.time_ns === undefined ? "" : timeText(each.time_ns)}</td>
                <td class="number">
                  <button
                    type="button"
                    disabled={busy}
                    onClick={() => void run(() => api.send("POST", `/api/v1/snapshots/${segment(each.name)}/restore`))}
                  >
                    Go back to it
                  </button>
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      ) : (
        <p class="empty">{list.error ? list.error.message : "No snapshot so far."}</p>
      )}
    </section>
  );
}
