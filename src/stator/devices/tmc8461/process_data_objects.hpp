#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "stator/dictionary/declaration.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::devices::tmc8461 {

/// Names for process data of a fixed size, byte by byte: what SII image and ESI file list, so that
/// masters find outputs in sync manager 2 and inputs in sync manager 3. No SDO reaches them.
class ProcessDataObjects {
 public:
  static constexpr std::size_t kMaximumBytes = 128;  ///< of each direction

  /// Throws std::logic_error for more bytes than that.
  ProcessDataObjects(std::size_t output_bytes, std::size_t input_bytes);

  [[nodiscard]] const dictionary::Dictionary& dictionary() const { return dictionary_; }
  [[nodiscard]] dictionary::Dictionary& dictionary() { return dictionary_; }

 private:
  void declare(std::size_t bytes, bool outputs);

  std::vector<std::string> names_;  ///< declarations refer to them
  std::vector<dictionary::EntryDeclaration> declarations_;
  dictionary::Dictionary dictionary_;
};

}  // namespace stator::devices::tmc8461
