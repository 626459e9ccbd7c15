#include "cli/logging.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace stator::cli {

std::shared_ptr<spdlog::logger> make_logger() {
  if (auto existing = spdlog::get("stator"); existing != nullptr) {
    return existing;
  }
  auto logger = spdlog::stderr_color_mt("stator");
  logger->set_pattern("%^%L%$ %v");
  logger->flush_on(spdlog::level::info);
  return logger;
}

}  // namespace stator::cli
