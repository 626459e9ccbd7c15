// Any text as an electronic data sheet: what is read makes a dictionary, is in order and of bounded
// size, and its names are UTF-8; what is refused is told with a rule and a sentence.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "input.hpp"
#include "stator/canopen/eds/eds.hpp"
#include "stator/canopen/eds/eds_file.hpp"
#include "stator/canopen/eds/eds_objects.hpp"
#include "stator/canopen/eds/eds_values.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace {

using stator::canopen::EdsFile;
using stator::fuzz::require;

bool holds_bytes(const stator::dictionary::EntryDeclaration& row) {
  using stator::dictionary::DataType;
  return is_string(row.type) && row.type != DataType::visible_string &&
         !row.default_value.text.empty();
}

/// What a file was read as can be a device, whose own data sheet is read again.
void require_device(const EdsFile& file) {
  using namespace stator;
  const auto& rows = file.objects.rows();
  require(!rows.empty() && rows.size() <= canopen::kMostEntries);
  for (const dictionary::EntryDeclaration& row : rows) {
    require(!row.name.empty() && canopen::is_utf8(row.name) && canopen::is_utf8(row.object_name));
  }
  dictionary::Dictionary dictionary;
  dictionary.add(rows);
  dictionary.finish();
  dictionary.set_node_id(127);
  dictionary.reset_values();
  // Bytes of any value would be lines of their own in the text.
  if (std::ranges::any_of(rows, holds_bytes)) {
    return;
  }
  const std::string again = canopen::eds_text(dictionary, {.vendor_name = file.vendor_name});
  dictionary::ImportReport report;
  const auto same = canopen::read_eds(again, report);
  require(same.has_value() && same->objects.rows().size() == rows.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stator;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  dictionary::ImportReport report;
  const auto file = canopen::read_eds(text, report);
  for (const dictionary::ImportNote& note : report.notes) {
    require(!note.rule.empty() && canopen::is_utf8(note.text) && note.line <= size);
  }
  if (!file) {
    require(!file.error().rule.empty() && !file.error().text.empty());
    return 0;
  }
  require_device(*file);
  return 0;
}
