"""Pages of the web server's interface, made of its OpenAPI document."""

import json

from .pages import plain, table, text

PAGE = "rest/calls"
TYPES = "rest/types"


def kind(schema):
    """What a value of a schema is, in HTML; types that have a name lead to it."""
    if reference := schema.get("$ref"):
        name = reference.rpartition("/")[2]
        return f'<a href="types.html#{name.lower()}">{name}</a>'
    if "const" in schema:
        return f"<code>{text(json.dumps(schema['const']))}</code>"
    if choices := schema.get("enum"):
        return ", ".join(f"<code>{text(json.dumps(choice))}</code>" for choice in choices)
    if either := schema.get("oneOf") or schema.get("anyOf"):
        return " or ".join(kind(one) for one in either)
    if "items" in schema:
        return f"list of {kind(schema['items'])}"
    types = schema.get("type", "anything")
    words = " or ".join(types) if isinstance(types, list) else types
    if inside := schema.get("properties"):
        return "object: " + ", ".join(f"<code>{text(name)}</code> {kind(one)}" for name, one in inside.items())
    if isinstance(schema.get("additionalProperties"), dict):
        return f"object of {kind(schema['additionalProperties'])}"
    if "minimum" in schema or "maximum" in schema:
        words += f", {schema.get('minimum', '')} to {schema.get('maximum', '')}"
    return words + (f", <code>{text(schema['pattern'])}</code>" if "pattern" in schema else "")


def remark(schema):
    """What a schema says of itself."""
    parts = [schema.get("description", "")]
    parts += [f"e.g. {json.dumps(example)}" for example in schema.get("examples", ())]
    if "default" in schema:
        parts.append(f"by default {json.dumps(schema['default'])}")
    return text("; ".join(part for part in parts if part))


def call(method, path, operation):
    """The section of one call."""
    needs_token = {} not in operation.get("security", [{}])
    lines = [
        f"({operation['operationId']})=",
        "",
        f"### {method.upper()} {plain(path)}",
        "",
        plain(operation["summary"]) + ".",
        "",
    ]
    lines += ["Needs the token." if needs_token else "Needs no token on loopback.", ""]
    if parameters := operation.get("parameters"):
        rows = [
            (
                None,
                [
                    f"<code>{text(one['name'])}</code>",
                    one["in"],
                    kind(one.get("schema", {})),
                    text(one.get("description", "")),
                ],
            )
            for one in parameters
        ]
        lines.append(table(("Parameter", "In", "Value", "Meaning"), rows))
    rows = []
    for media, body in operation.get("requestBody", {}).get("content", {}).items():
        rows.append((None, ["request", media, kind(body.get("schema", {})), ""]))
    for status, answer in operation["responses"].items():
        for media, body in (answer.get("content") or {"": {}}).items():
            rows.append(
                (None, [status, media, kind(body["schema"]) if "schema" in body else "", text(answer["description"])])
            )
        for side, message in answer.get("x-messages", {}).items():
            rows.append((None, [f"{status}, message of the {side}", "", kind(message), ""]))
    lines.append(table(("Status", "Content", "Value", "Meaning"), rows))
    return "\n".join(lines)


def write(document, pages):
    """Writes a page of all calls, a section each, and one of the types of their values."""
    lines = [
        "# REST calls",
        "",
        plain(document["info"]["description"]),
        "",
        "How to use them: [watching a running rack](../how-to/watch-a-rack.md). "
        "The same for programs: [openapi.json](../openapi.json.md). [Types of the values](types.md).",
        "",
    ]
    group = None
    for path, operations in document["paths"].items():
        # Calls of the same part of the interface stand together.
        name = path.split("/")[3] if path.startswith("/api/v1/") else "the server itself"
        if name != group:
            group = name
            lines += [f"## Of {name}", ""]
        for method, operation in operations.items():
            lines.append(call(method, path, operation))
            pages.entry(f"{method.upper()} {path}", "call", PAGE, operation["operationId"].lower())
    pages.write(PAGE, "\n".join(lines))
    lines = ["# Types of REST values", "", "Members in **bold** are always there.", ""]
    for name, schema in document["components"]["schemas"].items():
        lines += [f"## {name}", "", remark(schema), ""]
        members = schema.get("properties")
        if not members:
            lines += [f"<p>{kind(schema)}</p>", ""]
            continue
        rows = []
        for member, inside in members.items():
            code = f"<code>{text(member)}</code>"
            always = member in schema.get("required", ())
            rows.append((None, [f"<strong>{code}</strong>" if always else code, kind(inside), remark(inside)]))
        lines.append(table(("Member", "Value", "Meaning"), rows))
    pages.write(TYPES, "\n".join(lines))
