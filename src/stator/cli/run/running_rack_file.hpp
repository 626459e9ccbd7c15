#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "stator/cli/run/run_options.hpp"
#include "stator/web/rack_file_control.hpp"

namespace stator::cli {

/// The rack file of "stator run", and the wish to go on with another.
class RunningRackFile final : public web::RackFileControl {
 public:
  /// `options`: those of the run; `fixed`: why it can run no other rack, empty if it can;
  /// `refusal`: why it does not run the one that was asked for before. Throws Failure if the file
  /// of `options` cannot be read.
  RunningRackFile(const RunOptions& options, std::string fixed, std::string refusal);

  [[nodiscard]] File file() override { return file_; }
  base::Expected<std::string, std::string> replace(const std::string& text) override;
  /// The path of the rack file that replace() was asked for last; nothing: it was not called.
  [[nodiscard]] std::optional<std::string> wished();

 private:
  RunOptions options_;
  File file_;
  std::mutex mutex_;  ///< guards wished_
  std::optional<std::string> wished_;
};

}  // namespace stator::cli
