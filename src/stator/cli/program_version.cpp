#include "stator/cli/program_version.hpp"

namespace stator::cli {

std::string program_version() {
  return STATOR_VERSION;
}

}  // namespace stator::cli
