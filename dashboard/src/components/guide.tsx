import { tx } from "../language";
// Where the documentation says more. It lies in the repository and has no address that the page could know, so its
// path is told.

/// `path` is below docs/, perhaps with an anchor.
export function Guide({ path }: { path: string }) {
  return <span class="guide soft">{tx("More in {code} of Stator's repository", { code: <code>docs/{path.split("#")[0]}</code> })}</span>;
}
