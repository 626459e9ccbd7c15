import { useState } from "preact/hooks";

import { segment, type Api, type Recording, type Snapshots } from "../api";
import { CopyButton } from "../components/copy_button";
import { sizeText, timeText } from "../format";
import { useAction, useResource, useStore, useWorld } from "../hooks";
import { t, tx } from "../language";
import { href } from "../router";
import { saveFile } from "../save_file";

function Facts({ recording }: { recording: Recording }) {
  const command = `stator replay ${recording.file}`;
  return (
    <>
      <table>
        <tbody>
          <tr>
            <td class="soft">{t("File")}</td>
            <td>{recording.file}</td>
          </tr>
          <tr>
            <td class="soft">{t("Recorded")}</td>
            <td>{timeText(recording.time_ns)}</td>
          </tr>
          <tr>
            <td class="soft">{t("Size")}</td>
            <td>{sizeText(recording.bytes)}</td>
          </tr>
        </tbody>
      </table>
      <div class="body replay">
        <p>
          {tx(
            "{value}, to the bit and as often as you like, in a terminal where {code} was started; of a download, with its place instead:",
            { value: recording.running ? t("When it has stopped, this replays it") : t("This replays it"), code: <code>stator run</code> },
          )}
        </p>
        <div class="toolbar">
          <code>{command}</code>
          <CopyButton text={command} name={t("the command that replays it")} />
        </div>
      </div>
      {recording.complete ? null : <p class="notice bad">{t("The recording has ended early: the disk could not keep up, or is full.")}</p>}
    </>
  );
}

/// The file of the recording, fetched piece by piece.
async function download(api: Api, recording: Recording): Promise<void> {
  const pieces: ArrayBuffer[] = [];
  let from = 0;
  for (;;) {
    const response = await api.fetch("GET", `/api/v1/recording/content?from=${from}`, { accept: "application/octet-stream" });
    const piece = await response.arrayBuffer();
    if (piece.byteLength === 0) {
      break;
    }
    pieces.push(piece);
    from += piece.byteLength;
  }
  saveFile(recording.file?.split("/").at(-1) ?? "run.stator", new Blob(pieces, { type: "application/octet-stream" }));
}

function Running({ recording, reload }: { recording: Recording; reload: () => void }) {
  const { api } = useWorld();
  const { busy, error, run } = useAction();
  const stop = async () => {
    if (await run(() => api.send("DELETE", "/api/v1/recording"))) {
      reload();
    }
  };
  return (
    <>
      <div class="body toolbar">
        <button type="button" class="primary" disabled={busy} onClick={() => void stop()}>
          {t("Stop recording")}
        </button>
        <button type="button" disabled={busy} onClick={() => void run(() => download(api, recording))}>
          {t("Download what there is")}
        </button>
        <span class="soft">{t("The rack goes on when the recording stops.")}</span>
      </div>
      <p class="body">
        {tx("Do now what is to be kept: move an axis on the page of {link}, put {link2}, run your master. Then come back and stop.", {
          link: <a href={href("rack")}>{t("a device")}</a>,
          link2: <a href={href("faults")}>{t("a fault")}</a>,
        })}
      </p>
      {error === "" ? null : <p class="notice bad">{error}</p>}
    </>
  );
}

function Start({ recording }: { recording: Recording }) {
  const { api } = useWorld();
  const [name, setName] = useState(() => recordingName(new Date()));
  const { busy, error, run } = useAction();
  const [begun, setBegun] = useState(false);
  const start = async () => setBegun(await run(() => api.send("POST", "/api/v1/recording", { name })));
  return (
    <>
      {recording.file === null ? null : (
        <div class="body toolbar">
          <button type="button" disabled={busy} onClick={() => void run(() => download(api, recording))}>
            {t("Download")}
          </button>
        </div>
      )}
      <p class="body">
        {t(
          "A recording keeps all that reaches the rack, from power-on on. So the rack begins anew: its devices are switched on again, and masters find their network gone for a moment.",
        )}
      </p>
      <form
        class="body toolbar"
        onSubmit={(event) => {
          event.preventDefault();
          void start();
        }}
      >
        <label class="field">
          <span>{t("Name of the file, without .stator")}</span>
          <input value={name} required pattern={kNamePattern} onInput={(event) => setName(event.currentTarget.value)} />
        </label>
        <button type="submit" class="primary" disabled={busy || begun || name === ""}>
          {t("Restart the rack and record")}
        </button>
      </form>
      {begun ? <p class="body soft">{t("The rack begins anew …")}</p> : null}
      {error === "" ? null : <p class="notice bad">{error}</p>}
    </>
  );
}

/// A name that no recording has yet, e.g. "run-20261128-112830".
function recordingName(now: Date): string {
  const two = (n: number) => String(n).padStart(2, "0");
  const day = `${now.getFullYear()}${two(now.getMonth() + 1)}${two(now.getDate())}`;
  return `run-${day}-${two(now.getHours())}${two(now.getMinutes())}${two(now.getSeconds())}`;
}

const kNamePattern = "[A-Za-z_\\-][A-Za-z0-9_\\-]*";

export function RecordingView() {
  const store = useStore();
  const recording = useResource<Recording>("/api/v1/recording", 1000);
  return (
    <>
      <div class="view-head">
        <h1>{t("Recording")}</h1>
        <span class="soft">{t("All that reaches the rack, to be replayed to the bit")}</span>
      </div>
      <div class="two-columns">
        <section class="panel">
          <header>
            <h2>{t("Recording of this run")}</h2>
            {recording.data?.running ? <span class="badge bad">{t("recording")}</span> : null}
          </header>
          {recording.data === null || recording.data.file === null ? null : <Facts recording={recording.data} />}
          {recording.data === null ? null : recording.data.running ? (
            <Running recording={recording.data} reload={recording.reload} />
          ) : (
            <Start recording={recording.data} />
          )}
          {recording.error ? <p class="empty">{recording.error.message}</p> : null}
        </section>
        {store.offers("/api/v1/snapshots") && recording.data !== null && recording.data.file !== null ? <Snapshots /> : null}
        {recording.data !== null && recording.data.file === null ? (
          <section class="panel">
            <header>
              <h2>{t("Snapshots")}</h2>
            </header>
            <p class="empty">{t("Moments to go back to are places in a recording: start one, then keep the present state here.")}</p>
          </section>
        ) : null}
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
        <h2>{t("Snapshots")}</h2>
      </header>
      <form
        class="body toolbar"
        onSubmit={(event) => {
          event.preventDefault();
          void take();
        }}
      >
        <label class="field">
          <span>{t("Name")}</span>
          <input value={name} required pattern={kNamePattern} onInput={(event) => setName(event.currentTarget.value)} />
        </label>
        <button type="submit" class="primary" disabled={busy || name === ""}>
          {t("Keep the present state")}
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
                    {t("Go back to it")}
                  </button>
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      ) : (
        <p class="empty">
          {list.error
            ? list.error.message
            : t("No snapshot so far. Give the present moment a name; the rack can go back to it as often as you like.")}
        </p>
      )}
    </section>
  );
}
