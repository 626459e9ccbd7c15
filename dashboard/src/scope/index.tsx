import type { Api } from "../api";

/// The oscilloscope.
export function Scope(_: { api: Api }) {
  return (
    <>
      <h1>Oscilloscope</h1>
      <p class="empty">The oscilloscope is not part of this build.</p>
    </>
  );
}
