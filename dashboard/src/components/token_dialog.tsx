import { useEffect, useRef, useState } from "preact/hooks";

import { useWorld } from "../hooks";
import { t, tx } from "../language";

/// Asks for the token. The browser's own dialogue keeps the focus inside and closes with Escape.
export function TokenDialog({ open, onClose }: { open: boolean; onClose: () => void }) {
  const { api } = useWorld();
  const dialog = useRef<HTMLDialogElement>(null);
  const [text, setText] = useState("");
  useEffect(() => {
    if (open && dialog.current && !dialog.current.open) {
      setText(api.token);
      dialog.current.showModal();
    }
  }, [open, api]);
  const close = () => dialog.current?.close();
  return (
    <dialog ref={dialog} onClose={onClose} aria-labelledby="token-title">
      <form
        onSubmit={(event) => {
          event.preventDefault();
          api.token = text.trim();
          close();
        }}
      >
        <h2 id="token-title">{t("Token of this rack")}</h2>
        <p class="soft">
          {tx(
            "Changes need the token that {code} printed, or that of the file named with {code2}. It is forgotten when this tab is closed.",
            { code: <code>stator run --http</code>, code2: <code>--http-token</code> },
          )}
        </p>
        <label class="field">
          <span>{t("Token")}</span>
          <input type="password" autocomplete="off" value={text} onInput={(event) => setText(event.currentTarget.value)} />
        </label>
        <div class="toolbar">
          <span class="spacer" />
          <button type="button" onClick={close}>
            {t("Cancel")}
          </button>
          <button type="submit" class="primary">
            {t("Use it")}
          </button>
        </div>
      </form>
    </dialog>
  );
}
