"""What a device must hold after a restart, judged by what it has answered."""


class KeptModel:
    """Cells by name. An order sets some of them together; until it is answered they may be old or new, but
    not some old and some new. What was answered must be there; what was refused must not."""

    def __init__(self):
        self.cells = {}  # as the last answer left them
        self.ordered = None  # {cell: value} of the order that has no answer yet
        self.denied = {}  # {cell: value} that was refused last
        self.begin = {}  # as they were read back last

    def order(self, changes):
        assert self.ordered is None, "one order at a time"
        self.ordered = dict(changes)

    def answered(self):
        self.cells.update(self.ordered)
        self.denied = {cell: value for cell, value in self.denied.items() if cell not in self.ordered}
        self.ordered = None

    def refused(self):
        self.denied.update(self.ordered)
        self.ordered = None

    def compare(self, found):
        """Takes what was read back for true from now on. A list of (kind, sentence); kind is "lost", "torn", or
        "other" for what is there although it was refused."""
        faults = []
        ordered, self.ordered = self.ordered or {}, None
        if self.cells:
            fresh = [cell for cell in ordered if self.cells[cell] != ordered[cell]]
            states = {self._state(cell, found[cell], ordered[cell]) for cell in fresh}
            lost = [cell for cell, old in self.cells.items() if found[cell] not in (old, ordered.get(cell, old))]
            denied = [
                cell for cell in lost if cell in self.denied and found[cell] == self.denied[cell] != self.begin[cell]
            ]
            if denied:
                faults.append(("other", f"{len(denied)} cells that were refused are there, e.g. {denied[0]}"))
            elif lost:
                cell = lost[0]
                faults.append(
                    (
                        "lost",
                        f"{len(lost)} cells, e.g. {cell} is {_short(found[cell])}, "
                        f"{_short(self.cells[cell])} was answered"
                        + (f", {_short(ordered[cell])} ordered" if cell in ordered else ""),
                    )
                )
            if states == {"old", "new"}:
                new = [cell for cell in fresh if found[cell] == ordered[cell]]
                faults.append(
                    (
                        "torn",
                        f"of an order for {len(fresh)} cells that was not answered {len(new)} are new, e.g. {new[0]}",
                    )
                )
        self.cells, self.begin, self.denied = dict(found), found, {}
        return faults

    def _state(self, cell, value, new):
        return "new" if value == new else "old" if value == self.cells[cell] else "other"


def _short(value):
    text = value.hex() if isinstance(value, bytes) else repr(value)
    return text if len(text) <= 40 else f"{text[:32]}... ({len(value)} long)"
