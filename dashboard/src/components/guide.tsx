// Where the documentation says more. It lies in the repository and has no address that the page could know, so its
// path is told.

/// `path` is below docs/, perhaps with an anchor.
export function Guide({ path }: { path: string }) {
  return (
    <span class="guide soft">
      More in <code>docs/{path.split("#")[0]}</code> of Stator's repository
    </span>
  );
}
