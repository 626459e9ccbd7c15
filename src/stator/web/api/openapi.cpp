// The OpenAPI 3.1 document of the web server: its schemas, and paths made from the table of routes.
#include <algorithm>
#include <string>

#include <nlohmann/json.hpp>

#include "stator/web/api/manual_schemas.hpp"
#include "stator/web/api/panel_schemas.hpp"
#include "stator/web/api/routes.hpp"
#include "stator/web/api/stream_schemas.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

constexpr unsigned kSwitchingProtocols = 101;

/// The schemas that routes name (JSON Schema 2020-12, as OpenAPI 3.1 has it).
constexpr const char* kSchemas = R"({
  "Any": {"type": "object"},
  "Problem": {
    "type": "object",
    "description": "Problem details (RFC 9457); what a device refused also has its SDO abort code",
    "required": ["type", "title", "status", "detail"],
    "properties": {
      "type": {"type": "string"},
      "title": {"type": "string"},
      "status": {"type": "integer"},
      "detail": {"type": "string"},
      "abort_code": {"type": "string", "examples": ["0x06090031"]},
      "abort_text": {"type": "string"}
    }
  },
  "Recording": {
    "type": "object",
    "required": ["file", "time_ns", "bytes", "complete", "running"],
    "properties": {
      "file": {"type": ["string", "null"], "description": "null: nothing has been recorded"},
      "time_ns": {"type": "integer", "description": "Simulated time up to which it goes"},
      "bytes": {"type": "integer", "description": "Written so far"},
      "complete": {"type": "boolean", "description": "false: it ended because the disk was too slow or is full"},
      "running": {"type": "boolean", "description": "false: nothing is recorded, or the recording has been ended"}
    }
  },
  "Snapshots": {
    "type": "object",
    "required": ["snapshots"],
    "properties": {"snapshots": {"type": "array", "items": {
      "type": "object",
      "required": ["name", "time_ns"],
      "properties": {"name": {"type": "string"}, "time_ns": {"type": "integer"}}
    }}}
  },
  "SnapshotName": {
    "type": "object",
    "required": ["name"],
    "properties": {"name": {"type": "string", "pattern": "^[A-Za-z_-][A-Za-z0-9_-]{0,63}$"}}
  },
  "RackFile": {
    "type": "object",
    "required": ["path", "text", "changes", "fixed", "refusal"],
    "properties": {
      "path": {"type": "string", "description": "Empty: there is none"},
      "text": {"type": "string"},
      "changes": {"type": "array", "items": {"type": "string"}, "description": "Made to it before it was read, PATH=VALUE, as the option --set has them"},
      "fixed": {"type": "string", "description": "Why no other rack can be run instead; empty: one can"},
      "refusal": {"type": "string", "description": "Why the rack that was asked for last does not run; empty: it does"}
    }
  },
  "RackText": {
    "type": "object",
    "required": ["text"],
    "additionalProperties": false,
    "properties": {"text": {"type": "string", "description": "Of a rack file; what it names is looked for beside the present one"}}
  },
  "RackCheck": {
    "type": "object",
    "required": ["errors", "warnings"],
    "properties": {
      "errors": {"type": "array", "items": {
        "type": "object",
        "required": ["file", "line", "column", "key", "message"],
        "properties": {
          "file": {"type": "string"},
          "line": {"type": "integer", "description": "From 1; 0: of no place in a file"},
          "column": {"type": "integer"},
          "key": {"type": "string", "description": "Empty: a table or the whole file"},
          "message": {"type": "string"}
        }
      }},
      "warnings": {"type": "array", "items": {"type": "string"}, "description": "What a run would warn of"}
    }
  },
  "RackPath": {
    "type": "object",
    "required": ["path"],
    "properties": {"path": {"type": "string", "description": "Of the file that was written"}}
  },
  "Done": {
    "type": "object",
    "required": ["time_ns"],
    "properties": {"time_ns": {"type": "integer", "description": "Simulated time at which it happened"}}
  },
  "Network": {
    "type": "object",
    "required": ["name", "kind", "received", "overruns", "worst_lag_ns"],
    "properties": {
      "name": {"type": "string"},
      "kind": {"enum": ["ethercat", "can", "serial"]},
      "received": {"type": "integer", "description": "Frames from masters and programs, bytes of a serial line"},
      "overruns": {"type": "integer"},
      "worst_lag_ns": {"type": "integer"}
    }
  },
  "Rack": {
    "type": "object",
    "required": ["run", "clock", "time_ns", "lost_ns", "networks", "devices", "signals"],
    "properties": {
      "run": {"type": "string", "description": "Names this run and no other: a rack that was started again or went back to a snapshot has another, and numbers of its events and faults begin anew"},
      "clock": {"enum": ["real", "lockstep"]},
      "time_ns": {"type": "integer", "description": "Simulated time since power-on"},
      "lost_ns": {"type": "integer", "description": "Time the machine was too slow for, by which simulated time has been set back"},
      "networks": {"type": "array", "items": {"$ref": "#/components/schemas/Network"}},
      "devices": {"type": "integer"},
      "signals": {"type": "integer"}
    }
  },
  "Device": {
    "type": "object",
    "required": ["name", "product", "network", "powered", "state", "network_state", "objects", "inputs", "per_revolution"],
    "properties": {
      "name": {"type": "string"},
      "product": {"type": "string"},
      "network": {"type": "string"},
      "powered": {"type": "boolean"},
      "state": {"enum": ["off", "pre-operational or below", "safe-operational", "operational"], "description": "What the device does with process data, the same words for all networks"},
      "network_state": {"type": ["string", "null"], "description": "The state as the device's own network names it, e.g. Init or Stopped, \"off\" without supply; null: its network has no states"},
      "objects": {"type": "integer", "description": "Entries of its dictionary"},
      "inputs": {"type": "integer"},
      "per_revolution": {
        "type": ["object", "null"],
        "description": "What a revolution of its motors is to masters, as the product leaves its box; null: not known",
        "required": ["position", "velocity"],
        "properties": {
          "position": {"type": "number", "description": "By how much the position differs after one revolution"},
          "velocity": {"type": "number", "description": "The velocity of one revolution per second"}
        }
      }
    }
  },
  "Devices": {
    "type": "object",
    "required": ["devices"],
    "properties": {"devices": {"type": "array", "items": {"$ref": "#/components/schemas/Device"}}}
  },
  "Signal": {
    "type": "object",
    "required": ["name", "unit", "value"],
    "properties": {
      "name": {"type": "string"},
      "unit": {"type": "string"},
      "value": {"type": ["number", "null"], "description": "null: not a finite number"}
    }
  },
  "Signals": {
    "type": "object",
    "required": ["time_ns", "signals"],
    "properties": {
      "time_ns": {"type": "integer"},
      "signals": {"type": "array", "items": {"$ref": "#/components/schemas/Signal"}}
    }
  },
  "Input": {
    "type": "object",
    "required": ["name", "unit", "minimum", "maximum", "group", "normal", "value"],
    "properties": {
      "name": {"type": "string"},
      "unit": {"type": "string"},
      "minimum": {"type": ["number", "null"]},
      "maximum": {"type": ["number", "null"]},
      "group": {"type": "string", "enum": ["other", "load", "supply", "switches", "sensors", "driver", "heat", "lines", "network"],
                "description": "what of the world around the device it belongs to"},
      "normal": {"type": "number", "description": "what holds while nobody has set it"},
      "value": {"type": ["number", "null"], "description": "null: never set so far"}
    }
  },
  "Inputs": {
    "type": "object",
    "required": ["inputs"],
    "properties": {"inputs": {"type": "array", "items": {"$ref": "#/components/schemas/Input"}}}
  },
  "InputValue": {
    "type": "object",
    "required": ["value"],
    "additionalProperties": false,
    "properties": {"value": {"type": "number"}}
  },
  "Declaration": {
    "type": "object",
    "required": ["index", "subindex", "name", "type", "access", "pdo", "unit", "minimum", "maximum", "default"],
    "properties": {
      "index": {"type": "string"},
      "subindex": {"type": "string"},
      "name": {"type": "string"},
      "type": {"type": "string"},
      "access": {"enum": ["ro", "rw", "wo", "const"]},
      "pdo": {"enum": ["no", "rx", "tx", "rxtx"]},
      "unit": {"type": "string"},
      "minimum": {"type": "string"},
      "maximum": {"type": "string"},
      "default": {"type": "string"}
    }
  },
  "Entry": {
    "allOf": [{"$ref": "#/components/schemas/Declaration"}],
    "type": "object",
    "required": ["value"],
    "properties": {
      "value": {
        "type": ["number", "string", "boolean", "null"],
        "description": "Octet strings and domains as hexadecimal digits; null: it cannot be read"
      }
    }
  },
  "Objects": {
    "type": "object",
    "required": ["device", "entries"],
    "properties": {
      "device": {"type": "string"},
      "entries": {"type": "array", "items": {"$ref": "#/components/schemas/Declaration"}}
    }
  },
  "Object": {
    "type": "object",
    "required": ["device", "entries"],
    "properties": {
      "device": {"type": "string"},
      "entries": {"type": "array", "items": {"$ref": "#/components/schemas/Entry"}}
    }
  },
  "EntryValue": {
    "type": "object",
    "required": ["value"],
    "additionalProperties": false,
    "properties": {
      "value": {
        "type": ["number", "string", "boolean"],
        "description": "Integers may be text such as \"0x1F\""
      }
    }
  },
  "Event": {
    "type": "object",
    "required": ["number", "time_ns", "device", "rule", "severity", "text", "meaning"],
    "properties": {
      "number": {"type": "integer"},
      "time_ns": {"type": "integer"},
      "device": {"type": "string"},
      "rule": {"type": "string"},
      "severity": {"enum": ["information", "refusal", "warning", "fault"]},
      "text": {"type": "string"},
      "meaning": {"type": "string", "description": "The standard's words for the AL status or abort code that it tells; empty: it tells none"}
    }
  },
  "Events": {
    "type": "object",
    "required": ["events"],
    "properties": {"events": {"type": "array", "items": {"$ref": "#/components/schemas/Event"}}}
  },
  "FaultParameter": {
    "type": "object",
    "required": ["name", "type", "unit", "minimum", "maximum", "choices", "default", "needed", "summary"],
    "properties": {
      "name": {"type": "string"},
      "type": {"enum": ["integer", "number", "duration", "text", "choice"]},
      "unit": {"type": "string"},
      "minimum": {"type": ["number", "null"], "description": "Of a duration in seconds"},
      "maximum": {"type": ["number", "null"]},
      "choices": {"type": "array", "items": {"type": "string"}},
      "default": {"type": "string", "description": "As in a rack file; empty: none"},
      "needed": {"type": "boolean"},
      "summary": {"type": "string"}
    }
  },
  "FaultInput": {
    "type": "object",
    "required": ["name", "of_peripheral", "keys"],
    "properties": {
      "name": {"type": "string", "description": "Of an axis, of a peripheral on a board, or of a device where the kind applies to that, without the names of these"},
      "of_peripheral": {"type": "boolean", "description": "Of a peripheral, which the key `peripheral` of the fault has to name in addition"},
      "keys": {
        "type": "object",
        "additionalProperties": {"type": ["integer", "string"]},
        "description": "With which a fault sets it, of those that decide which input it sets"
      }
    }
  },
  "FaultKind": {
    "type": "object",
    "required": ["name", "summary", "effect", "applies_to", "counts", "momentary", "target", "parameters", "inputs"],
    "properties": {
      "name": {"type": "string"},
      "summary": {"type": "string"},
      "effect": {"type": "string", "description": "What the master sees"},
      "applies_to": {"enum": ["port", "device", "bus", "axis", "line"]},
      "counts": {"type": "string", "description": "What \"count\" counts; empty: it takes none"},
      "momentary": {"type": "boolean", "description": "Over as soon as it has begun"},
      "target": {"type": "array", "items": {"$ref": "#/components/schemas/FaultParameter"}},
      "parameters": {"type": "array", "items": {"$ref": "#/components/schemas/FaultParameter"}},
      "inputs": {"type": "array", "items": {"$ref": "#/components/schemas/FaultInput"}, "description": "All that it can set around an axis or a device of some product"}
    }
  },
  "FaultKinds": {
    "type": "object",
    "required": ["kinds", "when"],
    "properties": {
      "kinds": {"type": "array", "items": {"$ref": "#/components/schemas/FaultKind"}},
      "when": {"type": "array", "items": {"$ref": "#/components/schemas/FaultParameter"}}
    }
  },
  "Fault": {
    "type": "object",
    "required": ["id", "name", "kind", "target", "state", "remaining", "remaining_ns", "remaining_count", "hits", "begun_ns", "ended_ns"],
    "properties": {
      "id": {"type": "integer"},
      "name": {"type": "string"},
      "kind": {"type": "string"},
      "target": {"type": "string"},
      "state": {"enum": ["armed", "active", "done"]},
      "remaining": {"type": "string", "description": "What it waits for or how long it goes on, in words"},
      "remaining_ns": {"type": ["integer", "null"]},
      "remaining_count": {"type": ["integer", "null"]},
      "hits": {"type": "integer"},
      "begun_ns": {"type": ["integer", "null"]},
      "ended_ns": {"type": ["integer", "null"]}
    }
  },
  "Faults": {
    "type": "object",
    "required": ["time_ns", "faults"],
    "properties": {
      "time_ns": {"type": "integer"},
      "faults": {"type": "array", "items": {"$ref": "#/components/schemas/Fault"}}
    }
  },
  "FaultRequest": {
    "type": "object",
    "required": ["kind"],
    "description": "The keys of a [[fault]], see docs/faults.md; durations are texts such as \"20ms\"",
    "properties": {"kind": {"type": "string"}, "when": {"type": "object"}}
  },
  "FaultNumber": {
    "type": "object",
    "required": ["id"],
    "properties": {"id": {"type": "integer"}}
  },
  "Cleared": {
    "type": "object",
    "required": ["time_ns", "cleared"],
    "properties": {"time_ns": {"type": "integer"}, "cleared": {"type": "integer"}}
  }
})";

Json reference(std::string_view schema) {
  return {{"$ref", "#/components/schemas/" + std::string(schema)}};
}

Json body_of(std::string_view content_type, const Json& schema) {
  Json content = Json::object();
  content[std::string(content_type.substr(0, content_type.find(';')))] = {{"schema", schema}};
  return content;
}

Json parameters_of(const Route& route) {
  Json all = Json::array();
  std::string_view path = route.path;
  for (std::size_t open = path.find('{'); open != std::string_view::npos; open = path.find('{')) {
    const std::size_t close = path.find('}');
    all.push_back({{"name", path.substr(open + 1, close - open - 1)},
                   {"in", "path"},
                   {"required", true},
                   {"schema", {{"type", "string"}}}});
    path.remove_prefix(close + 1);
  }
  if (!route.query.name.empty()) {
    all.push_back({{"name", route.query.name},
                   {"in", "query"},
                   {"description", route.query.description},
                   {"schema", {{"type", route.query.type}}}});
  }
  return all;
}

Json responses_of(const Route& route) {
  Json responses = Json::object();
  if (route.status != kSwitchingProtocols) {
    const Json text{{"type", "string"}};
    responses[std::to_string(route.status)] = {
        {"description", "Done"},
        {"content",
         body_of(route.content_type, route.schema.empty() ? text : reference(route.schema))}};
  }
  if (route.kept) {
    responses["304"] = {{"description", "The client has it"}};
  }
  responses["default"] = {{"description", "Refused"},
                          {"content", body_of("application/problem+json", reference("Problem"))}};
  if (route.stream()) {
    // OpenAPI has no words for messages.
    responses[std::to_string(kSwitchingProtocols)] = {
        {"description", "A WebSocket, see docs/how-to/watch-a-rack.md"},
        {"x-messages",
         {{"server", reference(route.server_messages)},
          {"client", reference(route.client_messages)}}}};
  }
  return responses;
}

Json operation_of(const Route& route) {
  Json operation{{"operationId", route.id}, {"summary", route.summary}};
  if (Json parameters = parameters_of(route); !parameters.empty()) {
    operation["parameters"] = std::move(parameters);
  }
  if (!route.request_schema.empty()) {
    operation["requestBody"] = {
        {"required", true},
        {"content", body_of("application/json", reference(route.request_schema))}};
  }
  operation["responses"] = responses_of(route);
  operation["security"] = Json::array({{{"token", Json::array()}}});
  if (!route.writes()) {
    operation["security"].push_back(Json::object());  // on loopback
  }
  return operation;
}

}  // namespace

std::string openapi_document() {
  Json document{{"openapi", "3.1.0"},
                {"info",
                 {{"title", "Stator"},
                  {"version", "1"},
                  {"description",
                   "A running rack of virtual motion-control devices. On loopback reading "
                   "needs no token; writing always does."}}},
                {"paths", Json::object()},
                {"components",
                 {{"schemas", Json::parse(kSchemas)},
                  {"securitySchemes", {{"token", {{"type", "http"}, {"scheme", "bearer"}}}}}}}};
  document["components"]["schemas"].update(Json::parse(kPanelSchemas));
  document["components"]["schemas"].update(Json::parse(kStreamSchemas));
  document["components"]["schemas"].update(Json::parse(kManualSchemas));
  for (const Route& route : routes()) {
    std::string method(route.method);
    std::ranges::transform(method, method.begin(),
                           [](char letter) { return static_cast<char>(letter - 'A' + 'a'); });
    document["paths"][std::string(route.path)][method] = operation_of(route);
  }
  return document.dump(2) + "\n";
}

}  // namespace stator::web
