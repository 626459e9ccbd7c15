#pragma once

namespace stator::web {

/// Schemas of the messages of WebSockets, in both directions.
inline constexpr const char* kStreamSchemas = R"({
  "Subscription": {
    "type": "object",
    "description": "Asks for samples of signals, and may be sent again at any time",
    "required": ["signals"],
    "properties": {
      "signals": {"type": "array", "items": {"type": "string"}, "description": "Patterns, * for any run of characters; none end the samples"},
      "period": {"type": "string", "description": "A multiple of 50us, 10s at most; 10ms if it is not given"},
      "format": {"enum": ["json", "binary"], "description": "Of samples, see docs/how-to/watch-a-rack.md"},
      "events": {"type": "boolean", "description": "Events come as well"}
    }
  },
  "SignalMessage": {
    "oneOf": [
      {"$ref": "#/components/schemas/Subscribed"},
      {"$ref": "#/components/schemas/Samples"},
      {"$ref": "#/components/schemas/NewEvents"},
      {"$ref": "#/components/schemas/WrongMessage"}
    ]
  },
  "Subscribed": {
    "type": "object",
    "required": ["type", "period_ns", "format", "events", "signals"],
    "properties": {
      "type": {"const": "subscribed"},
      "period_ns": {"type": "integer"},
      "format": {"enum": ["json", "binary"]},
      "events": {"type": "boolean"},
      "signals": {"type": "array", "description": "In the order in which their values come", "items": {
        "type": "object",
        "required": ["name", "unit"],
        "properties": {"name": {"type": "string"}, "unit": {"type": "string"}}
      }}
    }
  },
  "Samples": {
    "type": "object",
    "required": ["type", "dropped", "time_ns", "values"],
    "properties": {
      "type": {"const": "samples"},
      "dropped": {"type": "integer", "description": "Rows since the stream began that the client was too slow for"},
      "time_ns": {"type": "array", "items": {"type": "integer"}},
      "values": {"type": "array", "description": "One list for each signal; null: not a finite number", "items": {
        "type": "array", "items": {"type": ["number", "null"]}
      }}
    }
  },
  "NewEvents": {
    "type": "object",
    "required": ["type", "events"],
    "properties": {
      "type": {"const": "events"},
      "events": {"type": "array", "items": {"$ref": "#/components/schemas/Event"}}
    }
  },
  "WrongMessage": {
    "type": "object",
    "required": ["type", "problem"],
    "properties": {
      "type": {"const": "problem"},
      "problem": {"$ref": "#/components/schemas/Problem"}
    }
  },
  "TrafficFilter": {
    "type": "object",
    "description": "Asks for frames, and may be sent again at any time",
    "properties": {
      "networks": {"type": "array", "items": {"type": "string"}, "description": "None are all"},
      "filter": {"type": "string", "description": "Looked for in all that is said of a frame, in either case"},
      "frames": {"type": "boolean", "description": "false: a pause"}
    }
  },
  "TrafficMessage": {
    "oneOf": [
      {"$ref": "#/components/schemas/Watched"},
      {"$ref": "#/components/schemas/Frames"},
      {"$ref": "#/components/schemas/WrongMessage"}
    ]
  },
  "Watched": {
    "type": "object",
    "required": ["type", "networks", "filter", "frames"],
    "properties": {
      "type": {"const": "subscribed"},
      "networks": {"type": "array", "items": {"type": "string"}},
      "filter": {"type": "string"},
      "frames": {"type": "boolean"}
    }
  },
  "Frames": {
    "type": "object",
    "required": ["type", "dropped", "frames"],
    "properties": {
      "type": {"const": "frames"},
      "dropped": {"type": "integer", "description": "Frames that were too many, or that the client was too slow for"},
      "frames": {"type": "array", "items": {"$ref": "#/components/schemas/Frame"}}
    }
  },
  "Frame": {
    "type": "object",
    "required": ["number", "time_ns", "network", "direction", "summary", "fields", "raw"],
    "properties": {
      "number": {"type": "integer", "description": "Of all frames of the rack"},
      "time_ns": {"type": "integer"},
      "network": {"type": "string"},
      "direction": {"enum": ["request", "answer", "bus"]},
      "summary": {"type": "string"},
      "fields": {"type": "array", "description": "What, and its value", "items": {
        "type": "array", "minItems": 2, "maxItems": 2, "items": {"type": "string"}
      }},
      "raw": {"type": "string", "description": "Bytes as hexadecimal digits"}
    }
  }
})";

}  // namespace stator::web
