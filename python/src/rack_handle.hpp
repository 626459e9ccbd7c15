// stator._native.Rack: a session that Python owns.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "session.hpp"

namespace stator::python {

/// A device of a session.
struct DeviceHandle {
  std::shared_ptr<Session> session;
  rack::DeviceAddress address;
};

}  // namespace stator::python
