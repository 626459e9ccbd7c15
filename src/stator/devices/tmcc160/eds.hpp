#pragma once

#include <string>

#include "stator/dictionary/dictionary.hpp"

namespace stator::devices::tmcc160 {

/// The electronic data sheet of a TMCC160 with these objects, which are to have been finished.
/// `lss`: it has an LSS slave.
[[nodiscard]] std::string eds(const dictionary::Dictionary& dictionary, bool lss);

}  // namespace stator::devices::tmcc160
