# Run at build time: writes OUTPUT, a C++ source with the names of all events (base::EventRule) that are declared in the
# sources below SOURCES, so that scenarios can be told of a name that no event has. A rule's name stands before its
# severity.
file(GLOB_RECURSE files ${SOURCES}/*.hpp ${SOURCES}/*.cpp)
set(names "")
foreach(file IN LISTS files)
  file(READ ${file} text)
  string(REGEX MATCHALL "\"[a-z0-9-]+\",[ \n]*(base::)?Severity::" rules "${text}")
  foreach(rule IN LISTS rules)
    string(REGEX MATCH "\"[a-z0-9-]+\"" name "${rule}")
    list(APPEND names ${name})
  endforeach()
endforeach()
list(REMOVE_DUPLICATES names)
list(SORT names)
list(JOIN names ",\n    " names)
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[// Made by cmake/embed_event_names.cmake.
#include "stator/scenario/event_names.hpp"

#include <array>

namespace stator::scenario {

std::span<const std::string_view> event_names() {
  static constexpr auto kNames = std::to_array<std::string_view>({
    @names@});
  return kNames;
}

}  // namespace stator::scenario
]])
