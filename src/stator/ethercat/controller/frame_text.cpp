#include "stator/ethercat/controller/frame_text.hpp"

#include <array>
#include <cstddef>
#include <span>

#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/registers/register_table.hpp"

namespace stator::ethercat {

namespace {

unsigned channels_of(Channels channels) {
  switch (channels) {
    case Channels::fmmus:
      return SlaveController::kMaximumFmmus;
    case Channels::sync_managers:
      return SlaveController::kMaximumSyncManagers;
    case Channels::ports:
      return kPortsPerSlave;
    case Channels::one:
      break;
  }
  return 1;
}

std::string with_number(std::string_view name, unsigned channel) {
  std::string text(name);
  const std::size_t mark = text.find('#');
  if (mark != std::string::npos) {
    text.replace(mark, 1, std::to_string(channel));
  }
  return text;
}

}  // namespace

std::string_view to_text(Command command) {
  constexpr std::array<std::string_view, 15> kNames{"NOP",  "APRD", "APWR", "APRW", "FPRD",
                                                    "FPWR", "FPRW", "BRD",  "BWR",  "BRW",
                                                    "LRD",  "LWR",  "LRW",  "ARMW", "FRMW"};
  const auto number = static_cast<std::size_t>(command);
  return number < kNames.size() ? kNames[number] : "?";
}

std::string register_name(std::uint16_t address) {
  for (const std::span<const RegisterDeclaration> group : register_groups()) {
    for (const RegisterDeclaration& declaration : group) {
      const unsigned channels = channels_of(declaration.repetition.channels);
      const unsigned bytes = (declaration.width + 7U) / 8U;
      for (unsigned channel = 0; channel < channels; ++channel) {
        const unsigned first = declaration.address + channel * declaration.repetition.distance;
        if (address >= first && address < first + bytes) {
          return with_number(declaration.name, channel);
        }
      }
    }
  }
  return {};
}

}  // namespace stator::ethercat
