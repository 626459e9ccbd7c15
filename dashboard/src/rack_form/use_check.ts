import { useEffect, useState } from "preact/hooks";

import type { RackCheck } from "../api";
import { problemText, useWorld } from "../hooks";
import { t } from "../language";

const kPause = 350;

export interface Check {
  /// Of `text`; null: not yet.
  readonly result: RackCheck | null;
  readonly text: string;
  /// Why nothing can be said.
  readonly failure: string;
}

/// What the program says of a text, asked when nobody has typed for a moment.
export function useCheck(text: string | null): Check {
  const { api } = useWorld();
  const [token, setToken] = useState(api.token);
  const [check, setCheck] = useState<Check>({ result: null, text: "", failure: "" });
  useEffect(() => api.onToken(() => setToken(api.token)), [api]);
  useEffect(() => {
    if (text === null) {
      return undefined;
    }
    if (token === "") {
      setCheck({ result: null, text, failure: t("Checking needs the token: set it with the button “Read only” above.") });
      return undefined;
    }
    let over = false;
    const ask = async () => {
      try {
        const result = await api.send<RackCheck>("POST", "/api/v1/rack/check", { text });
        if (!over) {
          setCheck({ result, text, failure: "" });
        }
      } catch (error) {
        if (!over) {
          setCheck({ result: null, text, failure: problemText(error) });
        }
      }
    };
    const timer = setTimeout(() => void ask(), kPause);
    return () => {
      over = true;
      clearTimeout(timer);
    };
  }, [api, text, token]);
  return check;
}
