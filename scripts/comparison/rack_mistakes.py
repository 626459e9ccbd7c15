"""Wrong rack files without number, drawn from the JSON schema of rack files.

In every table every key gets every kind of value that does not belong there, and values at and beyond its limits.
"""

import dataclasses
import re

BARE = re.compile(r"[A-Za-z0-9_-]+")
DURATION = re.compile(r'"([0-9.]+)(ns|us|ms|s)" to "([0-9.]+)(ns|us|ms|s)"')

# What stands around a table that is looked at, so that only the table is wrong.
MODULE = {"type": '"tmcm-3315"', "name": '"gantry"'}
SERVO = {"type": '"tmc8670"', "name": '"servo"'}
SPINDLE = {"type": '"tmcc160"', "name": '"spindle"', "node_id": "5"}
FEEDER = {"type": '"tmcm-142"', "name": '"feeder"', "rs485": '"tcp:29142"'}
RACK = {"segment": [{"device": [MODULE, SERVO]}], "bus": [{"device": [SPINDLE]}], "device": [FEEDER]}

# Values that most keys do not take.
VALUES = {
    "text": '"what"',
    "whole": "12345678901",
    "fraction": "1.5",
    "truth": "true",
    "list": '[1, "a"]',
    "table": "{ x = 1 }",
    "negative": "-1",
    "empty": '""',
    "date": "2020-01-01T00:00:00Z",
    "time": '"99999999s"',
    "word": '"70 minutes"',
    "nan": "nan",
    "infinite": "-inf",
    "texts": '["a", "a"]',
    "wholes": "[99, -1]",
}


@dataclasses.dataclass
class Table:
    name: str
    properties: dict  # key: schema
    document: object  # takes the table's content, gives the rack's
    needed: dict  # keys that say what the table is, with their values
    last: str  # how its keys are known to be its own


def written(document):
    """As TOML; values that are no tables are written already."""
    lines = []

    def key_of(key):
        return key if BARE.fullmatch(key) else f'"{key}"'

    def put(table, path):
        for key, value in table.items():
            if not isinstance(value, (dict, list)):
                lines.append(f"{key_of(key)} = {value}")
        for key, value in table.items():
            place = f"{path}.{key_of(key)}" if path else key_of(key)
            if isinstance(value, dict):
                lines.append(f"\n[{place}]")
                put(value, place)
            elif isinstance(value, list):
                for element in value:
                    lines.append(f"\n[[{place}]]")
                    put(element, place)

    put(document, "")
    return "\n".join(lines).strip() + "\n"


class Schema:
    def __init__(self, schema):
        self.schema = schema

    def resolve(self, node):
        while "$ref" in node:
            node = self.schema["definitions"][node["$ref"].rpartition("/")[2]]
        return node

    def tables(self):
        root = self.schema["properties"]
        yield Table("rack", self._plain(root), lambda table: {**table, **RACK}, {}, "")
        for key in root:
            yield from self._below(key, key, root[key], lambda table: {**RACK, **table})

    def _plain(self, properties):
        return {key: node for key, node in properties.items() if not self._is_table(node)}

    def _is_table(self, node):
        node = self.resolve(node)
        return any(
            "properties" in self.resolve(each)
            or "additionalProperties" in each
            and each["additionalProperties"]
            or "items" in each
            and self._is_table(each["items"])
            for each in (node, *self._alternatives(node))
        )

    def _alternatives(self, node):
        return [self.resolve(each) for each in self.resolve(node).get("anyOf", [])]

    def _below(self, name, key, node, document):
        """The tables that begin at `key`; `document` takes the table in which the key stands."""
        node = self.resolve(node)
        for each in [node, *self._alternatives(node)]:
            if "items" in each and self._is_table(each["items"]):
                yield from self._table(name, self.resolve(each["items"]), lambda table: document({key: [table]}))
            elif isinstance(free := each.get("additionalProperties"), dict):
                inner = self.resolve(free)
                if self._is_table(inner):
                    yield from self._table(f"{name}.NAME", inner, lambda table: document({key: {"thing": table}}))
                else:
                    yield Table(name, {"2030:03": inner, "thing": inner}, lambda table: document({key: table}), {}, "")
            elif "properties" in each:
                yield from self._table(name, each, lambda table: document({key: table}))

    def _table(self, name, node, document):
        branches = node.get("allOf", [])
        if not branches:
            yield from self._one(name, node["properties"], self._needed(name, {}), document)
            return
        for branch in branches:
            ((selector, choice),) = branch["if"]["properties"].items()
            kinds = [choice["const"]] if "const" in choice else choice["enum"]
            then = branch.get("then", {})
            keys = self.resolve(then.get("propertyNames", {})).get("enum", list(node["properties"]))
            properties = {
                key: then.get("properties", {}).get(key, node["properties"].get(key, {}))
                for key in keys
                if key != selector
            }
            for kind in kinds:
                needed = self._needed(name, {selector: f'"{kind}"'})
                yield from self._one(f"{name}.{kind}", properties, needed, document)

    @staticmethod
    def _needed(name, needed):
        kind = next(iter(needed.values()), "").strip('"')
        if name in ("event", "fault"):
            on_can = kind.startswith(("can-", "duplicate", "delay", "bus-off", "error-passive"))
            on_line = kind.startswith("serial")
            on_servo = kind.startswith(("hall", "current", "encoder", "phase-short"))
            device = "spindle" if on_can else "feeder" if on_line else "servo" if on_servo else "gantry"
            needed |= {"device": f'"{device}"'}
        if name == "event":
            needed |= {"at": '"1ms"'}
        if name in ("fault", "event") and kind == "set":
            needed |= {"input": '"input0"', "value": "1"}
        if name == "segment":
            needed = {"device": [MODULE]}
        if name == "bus":
            needed = {"device": [SPINDLE]}
        if name == "wire":
            needed = {"from": '"gantry.output0"', "to": '"gantry.input0"'}
        if name == "record":
            needed = {"file": '"run.csv"'}
        if name == "line":
            needed = {"link": '"tcp:29142"'}
        return needed

    def _one(self, name, properties, needed, document):
        complete = lambda table: document({**needed, **table})  # noqa: E731
        yield Table(name, self._plain(properties), complete, needed, "")
        for key, node in properties.items():
            if self._is_table(node):
                yield from self._below(f"{name}.{key}", key, node, complete)


class Limits:
    """Values at the limits of a key and beyond; a key without limits gets what it does not take."""

    def __init__(self, schema, node):
        node = schema.resolve(node)
        forms = (node, *map(schema.resolve, node.get("anyOf", [])))
        self.node = next((form for form in forms if "minimum" in form), node)
        self.description = node.get("description", "")

    def at(self, end):
        if "minimum" in self.node:
            return repr(self.node["minimum" if end == "least" else "maximum"])
        if match := DURATION.search(self.description):
            return f'"{match[1]}{match[2]}"' if end == "least" else f'"{match[3]}{match[4]}"'
        if "enum" in self.node:
            return f'"{self.node["enum"][0 if end == "least" else -1]}"'
        return {"boolean": "true" if end == "most" else "false", "array": '["*"]'}.get(self.node.get("type"), '"name"')

    def beyond(self, end):
        if "minimum" in self.node:
            limit = self.node["minimum" if end == "least" else "maximum"]
            step = 1 if self.node.get("type") == "integer" else max(abs(limit) * 1e-6, 1e-12)
            return repr(limit - step if end == "least" else limit + step)
        if match := DURATION.search(self.description):
            return f'"-1{match[2]}"' if end == "least" else f'"{float(match[3]) * 2 + 1}{match[4]}"'
        if "enum" in self.node:
            word = str(self.node["enum"][0 if end == "least" else -1])
            return f'"{word}x"' if end == "least" else f'"{word[1:]}"'
        return "[]" if end == "least" else "{ }"

    def wrong_type(self):
        kind = self.node.get("type")
        if kind in ("integer", "number", "array", "object"):
            return '"many"'
        return "17"


def whole_tables(schema):
    """(what, text): of every table with all its keys wrong alike."""
    for table in schema.tables():
        keys = table.properties
        limits = {key: Limits(schema, node) for key, node in keys.items()}
        for what, value in VALUES.items():
            yield f"{table.name}: {what}", written(table.document(dict.fromkeys(keys, value)))
        for end in ("least", "most"):
            yield f"{table.name}: {end}", written(table.document({key: each.at(end) for key, each in limits.items()}))
            yield (
                f"{table.name}: beyond {end}",
                written(table.document({key: each.beyond(end) for key, each in limits.items()})),
            )
        yield (
            f"{table.name}: wrong type",
            written(table.document({key: each.wrong_type() for key, each in limits.items()})),
        )
        yield (
            f"{table.name}: misspelt",
            written(table.document({f"{key}s": each.at("least") for key, each in limits.items()})),
        )
        yield f"{table.name}: nothing but what is needed", written(table.document({}))


def single_keys(schema, rng, of_each_table):
    """(what, text): one key of a table wrong."""
    for table in schema.tables():
        for _ in range(of_each_table if table.properties else 0):
            key = rng.choice(list(table.properties))
            limits = Limits(schema, table.properties[key])
            values = {
                **VALUES,
                "least": limits.at("least"),
                "most": limits.at("most"),
                "beyond least": limits.beyond("least"),
                "beyond most": limits.beyond("most"),
            }
            what = rng.choice(list(values))
            yield f"{table.name}.{key}: {what}", written(table.document({key: values[what]}))
