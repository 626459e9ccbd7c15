#pragma once

namespace stator::web {

/// Schemas of manual control.
inline constexpr const char* kManualSchemas = R"({
  "ManualAxis": {
    "type": "object",
    "required": ["commands", "modes", "profile_velocity", "position_per_revolution", "velocity_per_revolution", "state", "enabled", "fault", "reached", "position", "velocity", "statusword", "controlword", "error_code", "mode", "executed", "refusal"],
    "description": "An axis under manual control; positions and velocities are in the units of the device",
    "properties": {
      "commands": {"type": "array", "items": {"$ref": "#/components/schemas/ManualCommandName"}, "description": "That it takes"},
      "modes": {"type": "array", "items": {"type": "integer"}, "description": "6502h: modes of operation that the drive has"},
      "profile_velocity": {"type": "number", "description": "At which it moves if nothing else is said; 0: not known"},
      "position_per_revolution": {"type": ["number", "null"], "description": "Of the motor, as the product leaves its box; null: not known"},
      "velocity_per_revolution": {"type": ["number", "null"], "description": "The velocity of one revolution per second; null: not known"},
      "state": {"type": "string"},
      "enabled": {"type": "boolean"},
      "fault": {"type": "boolean"},
      "reached": {"type": "boolean", "description": "It is where it was sent"},
      "position": {"type": ["number", "null"]},
      "velocity": {"type": ["number", "null"]},
      "statusword": {"type": ["integer", "null"], "description": "6041h; null: no drive of CiA 402"},
      "controlword": {"type": ["integer", "null"], "description": "Written last"},
      "error_code": {"type": ["integer", "null"], "description": "603Fh, in a fault"},
      "mode": {"type": ["integer", "null"], "description": "6061h"},
      "executed": {"type": "integer", "description": "Commands so far; what else is told is from after the last of them"},
      "refusal": {"type": "string", "description": "Why the last command was not carried out; empty: it was"}
    }
  },
  "ManualControl": {
    "type": "object",
    "required": ["device", "available", "phase", "text", "axes"],
    "properties": {
      "device": {"type": "string"},
      "available": {"type": "boolean", "description": "false: it cannot be controlled by hand, and text says why"},
      "phase": {"enum": ["off", "starting", "active", "ended"], "description": "Of a small master inside Stator; it ends when another master speaks on the network"},
      "text": {"type": "string", "description": "Why it has ended, or cannot be"},
      "axes": {"type": "array", "items": {"$ref": "#/components/schemas/ManualAxis"}, "description": "Of a device whose phase is active"}
    }
  },
  "ManualCommandName": {"enum": ["enable", "disable", "reset-fault", "jog", "move", "home", "stop", "quick-stop", "mode", "controlword"]},
  "ManualCommand": {
    "type": "object",
    "required": ["command"],
    "additionalProperties": false,
    "properties": {
      "command": {"$ref": "#/components/schemas/ManualCommandName"},
      "value": {"type": "integer", "description": "jog: velocity, for 0.4 s or until the command is repeated; move: position; mode: number of the mode; controlword: what is written to 6040h"},
      "relative": {"type": "boolean", "description": "move: by the value from where the axis is"},
      "velocity": {"type": "integer", "minimum": 1, "maximum": 2147483647, "description": "move: instead of the device's own"}
    }
  }
})";

}  // namespace stator::web
