#include "stator/cli/tmcl/program_files.hpp"

#include <cstdio>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/cli/files.hpp"

namespace stator::cli {

tmcl_tools::ProgramFiles program_files() {
  return {.read = [](const std::string& path) -> base::Expected<std::string, std::string> {
            try {
              return read_file(path);
            } catch (const Failure& failure) {
              return base::Unexpected{std::string(failure.what())};
            }
          },
          .tell = [](std::string_view line) { fmt::print(stderr, "{}\n", line); }};
}

}  // namespace stator::cli
