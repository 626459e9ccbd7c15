"""Lets the site's search find what is a row of a table: objects, registers, keys, options, calls.

scripts/docs_site writes search-entries.json beside the pages: a list of [name, kind, page, anchor].
"""

import json
from pathlib import Path

from sphinx.domains import Domain, ObjType

# Places that scorer.js knows: before pages whose text has the word, or behind. Keys of one name are many.
IN_FRONT = 0
BEHIND = 1
MANY = ("key", "option", "signal", "input", "quirk")


class Entries(Domain):
    """Names that stand at an anchor of a page and are no headings."""

    name = "stator"
    label = "Stator"
    object_types = {
        kind: ObjType(kind)
        for kind in ("object", "register", "parameter", "key", "option", "call", "signal", "input", "fault", "quirk")
    }

    def get_objects(self):
        """Every entry, in the shape that Sphinx puts into its index."""
        path = Path(self.env.srcdir) / "search-entries.json"
        for number, (name, kind, page, anchor) in enumerate(json.loads(path.read_text(encoding="utf-8"))):
            yield f"{number}", name, kind, page, anchor, BEHIND if kind in MANY else IN_FRONT

    def resolve_any_xref(self, *_):
        """Nothing: pages link to anchors by their files, not by these names."""
        return []

    def merge_domaindata(self, docnames, otherdata):
        """Nothing to do: pages that are read in parallel add no entries."""


def setup(app):
    """Called by Sphinx."""
    app.add_domain(Entries)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
