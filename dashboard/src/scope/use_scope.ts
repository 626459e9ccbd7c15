import { useEffect, useState } from "preact/hooks";

import type { Oscilloscope } from "./oscilloscope";

/// Renders again whenever the oscilloscope says that something has changed.
export function useScope(scope: Oscilloscope): void {
  const [, render] = useState({});
  useEffect(() => scope.onChange(() => render({})), [scope]);
}
