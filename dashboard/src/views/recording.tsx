import { useState } from "preact/hooks";

import { segment, type Recording, type Snapshots } from "../api";
import { sizeText, timeText } from "../format";
import { useAction, useResource, useStore, useWorld } from "../hooks";

function Facts({ recording }: { recording: Recording }) {
  return (
    <>
      <table>
        <tbody>
          <tr>
            <td class="soft">File</td>
            <td>{recording.file}</td>
          </tr>
          <tr>
            <td class="soft">Recorded</td>
            <td>{timeText(recording.time_ns)}</td>
          </tr>
          <tr>
            <td class="soft">Size</td>
            <td>{sizeText(recording.bytes)}</td>
          </tr>
        </tbody>
      </table>
      {recording.complete ? null : <p class="notice bad">The recording has ended early: the disk could not keep up, or is full.</p>}
    </>
  );
}

export function RecordingView() {
  const store = useStore();
  const recording = useResource<Recording>("/api/v1/recording", 1000);
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
          {recording.data?.file === null ? (
            <p class="empty">
              Nothing is recorded. Start with <code>stator run … --record NAME.stator</code> to have snapshots.
            </p>
          ) : recording.data ? (
            <Facts recording={recording.data} />
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
  const list = useResource<Snapshots>("/api/v1/snapshots", 2000);
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
                <td class="number">{timeText(each.time_ns)}</td>
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
