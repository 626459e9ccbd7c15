#include "stator/settings/problem.hpp"

namespace stator::settings {

Problem::Problem(std::string file, std::uint32_t line, std::uint32_t column, std::string key,
                 std::string reason)
    : file_(std::move(file)),
      line_(line),
      column_(column),
      key_(std::move(key)),
      reason_(std::move(reason)),
      text_(line == 0 ? file_ + ": " + reason_
                      : file_ + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " +
                            reason_) {}

}  // namespace stator::settings
