#pragma once

#include <vector>

#include "stator/dictionary/declaration.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/standard/device_description.hpp"

namespace stator::product {

/// Objects of a CoE device whose values follow from who it is and what of it can be mapped: device
/// type 1000h (no profile), error register 1001h, name 1008h, identity 1018h, communication types
/// 1C00h, one PDO in each direction with all that can be mapped, 1600h and 1A00h, and their
/// assignment 1C12h and 1C13h (ETG.1000.6 §5.6.7). Masters cannot change the process data.
class StandardObjects {
 public:
  /// Adds those that `objects`, which is not finished, has not. Both must outlive this.
  void add_missing(dictionary::Dictionary& objects, const ethercat::DeviceDescription& description);

 private:
  std::vector<dictionary::EntryDeclaration> rows_;
};

}  // namespace stator::product
