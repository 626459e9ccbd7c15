"""Which mutants of a campaign are looked at: a sample that depends on the seed and the sources only."""

import csv
import random
from dataclasses import dataclass

from places import find_places

PER_FILE = 40
NUMBERS_PER_FILE = 1024
CAPACITY = 1 << 20  # as in schemata.hpp


@dataclass
class Mutant:
    number: int
    room: str
    path: str  # relative to the tree
    line: int
    source: str  # the line's text
    original: str
    change: str
    place: object

    def __str__(self):
        return f"{self.path}:{self.line}: {self.original} -> {self.change}    in: {self.source}"


@dataclass
class Sample:
    mutants: list
    places: dict  # path: the places that have to be guarded
    equivalent: int  # left out because somebody found that they change nothing


def read_equivalent(path):
    """(file, line's text, original, change) of mutants that are known to change nothing."""
    if not path.exists():
        return set()
    with open(path, newline="", encoding="utf-8") as file:
        return {(row["file"], row["line"], row["original"], row["change"]) for row in csv.DictReader(file)}


def _original(place, text):
    if place.operator:
        return text[slice(*place.operator)]
    return " ".join(text[place.start : place.end].split())


def mutants_of(path, text, room):
    """Every mutant of one source, without numbers."""
    lines = text.splitlines()
    found = []
    for place in find_places(text):
        at = place.operator[0] if place.operator else place.start
        line = text.count("\n", 0, at) + 1
        found += [
            Mutant(0, room, path, line, lines[line - 1].strip(), _original(place, text), change, place)
            for change in place.changes
            if change is not None
        ]
    return found


def draw(root, rooms, count, seed, equivalent=frozenset()):
    """`count` mutants, the same number of each room, in an order that mixes the rooms.

    Files are drawn with a probability that grows with the mutants they offer, and of each at most
    PER_FILE mutants: compiling a file is what costs. All places of a drawn file are guarded, and
    their numbers depend on the file only, so that a compiler cache knows it the next time.
    """
    chosen, known, places = [], 0, {}
    for index, room in enumerate(rooms):
        generator = random.Random(f"{seed} {room}")
        share = count // len(rooms) + (index < count % len(rooms))
        files = {}
        for file in sorted((root / "src" / "stator" / room).rglob("*.cpp")):
            path = file.relative_to(root).as_posix()
            found = mutants_of(path, file.read_text(encoding="utf-8"), room)
            if found:
                files[path] = found
        order = sorted(files, key=lambda path: generator.random() ** (1 / len(files[path])), reverse=True)
        drawn = []
        for path in order:
            if len(drawn) >= share:
                break
            found = generator.sample(files[path], min(PER_FILE, len(files[path])))
            counted = [m for m in found if (m.path, m.source, m.original, m.change) not in equivalent]
            known += len(found) - len(counted)
            drawn += counted
            places[path] = files[path]
        chosen.append(drawn[:share])
    mixed = [mutant for drawn in chosen for mutant in drawn]
    random.Random(f"{seed} order").shuffle(mixed)
    return Sample(
        mixed,
        _numbered(places, sorted(path.relative_to(root).as_posix() for path in (root / "src").rglob("*.cpp"))),
        known,
    )


def _numbered(drawn, sources):
    """The places of each drawn file, whose mutants get their numbers here."""
    places = {}
    for path, mutants in drawn.items():
        number = 1 + NUMBERS_PER_FILE * sources.index(path)
        if len(mutants) >= NUMBERS_PER_FILE or number >= CAPACITY:
            raise ValueError(f"{path}: more mutants than there are numbers; raise them here and in schemata.hpp")
        for mutant in mutants:
            place = mutant.place
            if not place.identities:
                place.identities = list(range(number, number + len(place.changes)))
                number += len(place.changes)
                places.setdefault(path, []).append(place)
            mutant.number = place.identities[place.changes.index(mutant.change)]
    return places
