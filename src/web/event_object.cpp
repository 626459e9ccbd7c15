#include "web/event_object.hpp"

namespace stator::web {

nlohmann::ordered_json to_json(const EventRecord& event) {
  return {{"number", event.number}, {"time_ns", event.time.nanoseconds()}, {"device", event.device},
          {"rule", event.rule},     {"severity", to_text(event.severity)}, {"text", event.text}};
}

}  // namespace stator::web
