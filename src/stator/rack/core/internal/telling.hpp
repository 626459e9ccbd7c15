// Inline functions by which the sources of class Rack write commands to the journal.
#pragma once

#include "stator/rack/core/command.hpp"
#include "stator/rack/core/internal/rack_parts.hpp"
#include "stator/rack/core/rack.hpp"

namespace stator::rack {

inline Journal* Rack::listening() {
  return parts_->inside ? nullptr : parts_->journal;
}

template <typename Alternative>
void Rack::tell(const Alternative& command) {
  if (Journal* journal = listening(); journal != nullptr) [[unlikely]] {
    journal->command({command});
  }
}

}  // namespace stator::rack
