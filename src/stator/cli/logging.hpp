#pragma once

#include <memory>
#include <string_view>

#include "stator/link/system/background_output.hpp"
#include "stator/rack/observe/log.hpp"

namespace stator::cli {

/// A log that writes lines to standard error, in colour on a terminal only. Calls share one.
///
/// Logging never waits for a reader: lines go through a queue, and those that find no room are lost
/// and counted. When there is room again, a line says how many there were.
[[nodiscard]] std::shared_ptr<rack::Log> make_logger();

/// What the log writes to; null: there is no log yet.
[[nodiscard]] link::BackgroundOutput* log_output();

/// Lets what was logged come out before something else is said, as far as somebody reads it; see
/// link::BackgroundOutput::drain().
void drain_log(
    link::BackgroundOutput::Clock::time_point asked = link::BackgroundOutput::Clock::now());

/// Says on standard error why the program ends: "stator: ...". If there is a log, it does not
/// wait for somebody who does not read either.
void say_failure(std::string_view reason);

}  // namespace stator::cli
