// What was typed into the rack file and does not run yet. It outlasts the view and a reload of the page, e.g. in another language.

const kKey = "stator.rack-file.draft";

/// Where drafts are kept: that of the tab.
export type Drafts = Pick<Storage, "getItem" | "setItem" | "removeItem">;

interface Draft {
  /// Path of the file that it is to replace.
  readonly of: string;
  readonly text: string;
}

/// What was typed in place of the file `path`; null: nothing, or in place of another one, which ran before.
export function draftOf(path: string, drafts: Drafts = sessionStorage): string | null {
  try {
    const kept = JSON.parse(drafts.getItem(kKey) ?? "null") as Partial<Draft> | null;
    return kept?.of === path && typeof kept.text === "string" ? kept.text : null;
  } catch {
    return null; // not written by this page
  }
}

/// Keeps `text` for the file `path`; null: there is nothing to keep. Where the tab keeps nothing, it lasts as long as the view.
export function keepDraft(path: string, text: string | null, drafts: Drafts = sessionStorage): void {
  try {
    if (text === null) {
      drafts.removeItem(kKey);
    } else {
      drafts.setItem(kKey, JSON.stringify({ of: path, text } satisfies Draft));
    }
  } catch {
    // no room, or forbidden
  }
}
