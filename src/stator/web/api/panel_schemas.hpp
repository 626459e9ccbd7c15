#pragma once

namespace stator::web {

/// Schemas of the answers that describe what devices show and how they are wired.
inline constexpr const char* kPanelSchemas = R"({
  "Port": {
    "type": "object",
    "required": ["number", "link", "loop_closed", "neighbour", "invalid_frames", "rx_errors", "forwarded_errors", "lost_links"],
    "properties": {
      "number": {"type": "integer"},
      "link": {"type": "boolean"},
      "loop_closed": {"type": "boolean", "description": "Frames are turned back inside"},
      "neighbour": {"type": ["string", "null"], "description": "Device at the other end of the cable, or \"master\""},
      "invalid_frames": {"type": "integer"},
      "rx_errors": {"type": "integer"},
      "forwarded_errors": {"type": "integer"},
      "lost_links": {"type": "integer"}
    }
  },
  "WiredDevice": {
    "type": "object",
    "required": ["name", "after", "port", "entry_port", "ports"],
    "properties": {
      "name": {"type": "string"},
      "after": {"type": ["string", "null"], "description": "Device it hangs at; null: the master"},
      "port": {"type": ["integer", "null"], "description": "Of that device"},
      "entry_port": {"type": "integer"},
      "ports": {"type": "array", "items": {"$ref": "#/components/schemas/Port"}}
    }
  },
  "Segment": {
    "type": "object",
    "required": ["name", "link", "redundant", "carrier", "devices"],
    "properties": {
      "name": {"type": "string"},
      "link": {"type": "string"},
      "redundant": {"type": "boolean"},
      "carrier": {"type": "array", "items": {"type": "boolean"}, "description": "Of the master's primary and secondary interface"},
      "devices": {"type": "array", "items": {"$ref": "#/components/schemas/WiredDevice"}}
    }
  },
  "Bus": {
    "type": "object",
    "required": ["name", "bit_rate", "load", "ports", "devices"],
    "properties": {
      "name": {"type": "string"},
      "bit_rate": {"type": ["integer", "null"], "description": "Bit/s; null: unlimited"},
      "load": {"type": "number", "description": "Of the last full second, 0 to 1"},
      "ports": {"type": "array", "items": {"type": "string"}},
      "devices": {"type": "array", "items": {"type": "string"}}
    }
  },
  "Line": {
    "type": "object",
    "required": ["link", "devices"],
    "properties": {"link": {"type": "string"}, "devices": {"type": "array", "items": {"type": "string"}}}
  },
  "Wiring": {
    "type": "object",
    "required": ["segments", "buses", "lines"],
    "properties": {
      "segments": {"type": "array", "items": {"$ref": "#/components/schemas/Segment"}},
      "buses": {"type": "array", "items": {"$ref": "#/components/schemas/Bus"}},
      "lines": {"type": "array", "items": {"$ref": "#/components/schemas/Line"}}
    }
  },
  "Connection": {
    "type": "object",
    "required": ["program", "lines", "explanation", "guide"],
    "properties": {
      "program": {"type": "string", "examples": ["SOEM", "python-canopen", "PyTrinamic"]},
      "lines": {"type": "string", "description": "Ready to paste; empty: it cannot, the explanation says what to do"},
      "explanation": {"type": "string"},
      "guide": {"type": "string", "description": "Document below docs/ of the repository"}
    }
  },
  "LinkConnections": {
    "type": "object",
    "required": ["network", "link", "where", "programs"],
    "properties": {
      "network": {"type": "string", "description": "As /api/v1/rack names it"},
      "link": {"type": "string", "description": "With the port that was really opened; of a serial line what programs open"},
      "where": {"type": "string", "description": "Begins a sentence"},
      "programs": {"type": "array", "items": {"$ref": "#/components/schemas/Connection"}}
    }
  },
  "Connections": {
    "type": "object",
    "required": ["links"],
    "properties": {"links": {"type": "array", "items": {"$ref": "#/components/schemas/LinkConnections"}}}
  },
  "Refusal": {"anyOf": [{"$ref": "#/components/schemas/Event"}, {"type": "null"}]},
  "PanelAxis": {
    "type": "object",
    "required": ["name", "machine", "state", "mode", "mode_name", "signals", "last_refusal"],
    "properties": {
      "name": {"type": "string"},
      "machine": {"type": ["string", "null"], "description": "In /api/v1/state-machines; null: the axis has none"},
      "state": {"type": ["string", "null"]},
      "statusword": {"type": "integer"},
      "mode": {"type": ["integer", "null"]},
      "mode_name": {"type": ["string", "null"]},
      "signals": {"type": "object", "additionalProperties": {"type": "string"}, "description": "Names of signals by what they tell"},
      "last_refusal": {"$ref": "#/components/schemas/Refusal"}
    }
  },
  "Led": {
    "type": "object",
    "required": ["name", "colour", "pattern"],
    "properties": {
      "name": {"type": "string"},
      "colour": {"enum": ["green", "red"]},
      "pattern": {"type": "string", "examples": ["off", "on", "blinking", "flickering", "single flash", "double flash"]}
    }
  },
  "Panel": {
    "type": "object",
    "required": ["name", "powered", "leds", "network", "axes", "last_refusal", "program"],
    "properties": {
      "name": {"type": "string"},
      "powered": {"type": "boolean"},
      "leds": {"type": "array", "items": {"$ref": "#/components/schemas/Led"}},
      "network": {
        "type": ["object", "null"],
        "required": ["machine", "state", "status_code", "status_text"],
        "properties": {
          "machine": {"enum": ["esm", "nmt"]},
          "state": {"type": "string"},
          "status_code": {"type": "integer"},
          "status_text": {"type": "string"}
        }
      },
      "axes": {"type": "array", "items": {"$ref": "#/components/schemas/PanelAxis"}},
      "last_refusal": {"$ref": "#/components/schemas/Refusal"},
      "program": {"type": "boolean", "description": "It can run TMCL programs"}
    }
  },
  "StateMachine": {
    "type": "object",
    "required": ["name", "title", "states", "transitions"],
    "properties": {
      "name": {"enum": ["cia402", "esm", "nmt"]},
      "title": {"type": "string"},
      "states": {"type": "array", "items": {"type": "string"}},
      "transitions": {"type": "array", "items": {
        "type": "object",
        "required": ["from", "to", "number", "event"],
        "properties": {
          "from": {"type": "string"},
          "to": {"type": "string"},
          "number": {"type": "string", "description": "Number or short name in the standard"},
          "event": {"type": "string"}
        }
      }}
    }
  },
  "StateMachines": {
    "type": "object",
    "required": ["machines"],
    "properties": {"machines": {"type": "array", "items": {"$ref": "#/components/schemas/StateMachine"}}}
  },
  "Program": {
    "type": "object",
    "required": ["running", "line", "lines"],
    "properties": {
      "running": {"type": "boolean"},
      "line": {"type": ["integer", "null"], "description": "Address of the instruction that comes next"},
      "lines": {"type": "array", "items": {
        "type": "object",
        "required": ["address", "text"],
        "properties": {"address": {"type": "integer"}, "text": {"type": "string"}}
      }}
    }
  }
})";

}  // namespace stator::web
