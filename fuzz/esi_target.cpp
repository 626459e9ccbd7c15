// Any text as an ESI file: it is refused with rule and sentence, or each device that it lists is
// one whose objects make a dictionary; the same each time.

#include <string>
#include <string_view>
#include <tuple>

#include "input.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/formats/esi/esi_reader.hpp"

namespace stator::fuzz {
namespace {

void require_pdos(const std::vector<ethercat::ImportedPdo>& pdos) {
  for (const ethercat::ImportedPdo& pdo : pdos) {
    require(pdo.index != 0 && pdo.entries.size() < 255);
    for (const ethercat::ImportedPdo::Entry& entry : pdo.entries) {
      require(entry.index != pdo.index);
      require(entry.index == 0 || entry.index >= 0x20 || entry.subindex != 0);
      require(!entry.type || is_string(*entry.type) ||
              dictionary::bit_length(*entry.type) >= entry.bits);
    }
  }
}

void require_device(const ethercat::ImportedSlave& slave) {
  require(slave.objects.rows().size() <= 65'536);
  require(slave.receive_pdos.size() + slave.transmit_pdos.size() <= 4096);
  require_pdos(slave.receive_pdos);
  require_pdos(slave.transmit_pdos);
  const dictionary::EntryDeclaration* before = nullptr;
  for (const dictionary::EntryDeclaration& row : slave.objects.rows()) {
    require(before == nullptr ||
            std::tuple(before->index, before->subindex) < std::tuple(row.index, row.subindex));
    before = &row;
  }
  dictionary::Dictionary built;
  built.add(slave.objects.rows(), {});
  built.finish();  // throws if a declaration contradicts itself
}

}  // namespace
}  // namespace stator::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stator;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto devices = formats::esi_devices(text);
  if (!devices) {
    fuzz::require(!devices.error().rule.empty() && !devices.error().text.empty());
    return 0;
  }
  std::size_t tried = 0;
  for (const formats::EsiDevice& device : *devices) {
    constexpr std::size_t kMostTried = 4;
    if (++tried > kMostTried) {
      break;
    }
    formats::EsiChoice choice;
    choice.device = device.type.empty() ? std::to_string(device.product)
                                        : device.type + "@" + std::to_string(device.revision);
    dictionary::ImportReport report;
    dictionary::ImportReport again;
    const auto slave = formats::read_esi(text, choice, report);
    const auto same = formats::read_esi(text, choice, again);
    fuzz::require(slave.has_value() == same.has_value());
    fuzz::require(report.notes.size() == again.notes.size());
    for (const dictionary::ImportNote& note : report.notes) {
      fuzz::require(!note.rule.empty() && !note.text.empty());
    }
    if (slave) {
      fuzz::require_device(*slave);
      fuzz::require(slave->objects.rows().size() == same->objects.rows().size());
    } else {
      fuzz::require(!slave.error().rule.empty() && !slave.error().text.empty());
    }
  }
  return 0;
}
