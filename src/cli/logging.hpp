#pragma once

#include <memory>

namespace spdlog {
class logger;
}

namespace stator::cli {

/// A logger that writes lines to standard error, in colour on a terminal only. Calls share one
/// logger.
[[nodiscard]] std::shared_ptr<spdlog::logger> make_logger();

}  // namespace stator::cli
