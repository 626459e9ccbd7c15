#include "event_record.hpp"

#include "stator/base/event.hpp"
#include "stator/base/severity_text.hpp"

namespace stator::python {

std::vector<EventRecord> events_of(const rack::EventLog& log, std::uint64_t after) {
  std::vector<EventRecord> events;
  log.visit(after, [&](std::uint64_t number, const base::Event& event) {
    events.push_back({.number = number,
                      .time = event.time.seconds(),
                      .severity = std::string(base::to_text(event.rule->severity)),
                      .id = std::string(event.rule->id.view()),
                      .device = log.device_name(event),
                      .text = base::to_sentence(event)});
    return true;
  });
  return events;
}

}  // namespace stator::python
