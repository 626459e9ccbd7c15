#include "stator/master/process_data.hpp"

#include <algorithm>
#include <array>

#include "stator/dictionary/abort_code.hpp"
#include "stator/master/registers.hpp"
#include "stator/master/text.hpp"

namespace stator::master {

namespace {

constexpr std::uint8_t kOutputType = 3;  // of a sync manager in SII category 41
constexpr std::uint8_t kInputType = 4;
constexpr unsigned kDefaultOutputChannel = 2;
constexpr unsigned kDefaultInputChannel = 3;
constexpr std::uint16_t kAssignment = 0x1C10;  // plus the sync manager's number

// FMMU registers, ETG.1000.4 §6.6.
constexpr std::uint8_t kFmmuRead = 1;
constexpr std::uint8_t kFmmuWrite = 2;

// A frame also carries the datagram that keeps distributed clocks together.
constexpr std::size_t kClockDatagram = ethercat::kDatagramOverhead + 8;
constexpr std::size_t kMaximumFrameData = ethercat::kMaximumDatagramData - kClockDatagram;

bool does_not_exist(const Error& error) {
  return error.code == ErrorCode::sdo_aborted &&
         error.detail == static_cast<std::uint32_t>(dictionary::AbortCode::object_does_not_exist);
}

/// The slave's first sync manager of `type`; the customary channel if its SII does not say.
ProcessDataChannel find_channel(const SlaveInformation& information, std::uint8_t type,
                                unsigned customary) {
  const auto& all = information.sync_managers;
  const auto found = std::find_if(all.begin(), all.end(),
                                  [type](const auto& settings) { return settings.type == type; });
  ProcessDataChannel channel;
  channel.sync_manager =
      found == all.end() ? customary : static_cast<unsigned>(found - all.begin());
  if (channel.sync_manager < all.size()) {
    channel.settings = all[channel.sync_manager];
  }
  return channel;
}

template <typename T>
Result<T> upload_number(SdoClient& sdo, std::uint16_t index, std::uint8_t subindex) {
  const auto data = sdo.upload({index, subindex});
  if (!data) {
    return base::Unexpected{data.error()};
  }
  if (data->size() != sizeof(T)) {
    return fail(ErrorCode::configuration, to_text(ObjectAddress{index, subindex}) + " has " +
                                              std::to_string(data->size()) + " bytes, " +
                                              std::to_string(sizeof(T)) + " are expected");
  }
  return base::load_le<T>(data->data());
}

/// Appends the entries of one PDO (1600h.. or 1A00h..): index, subindex and bits in one number.
Result<std::uint32_t> append_pdo(SdoClient& sdo, std::uint16_t pdo, std::uint32_t bit_offset,
                                 std::vector<MappedEntry>& entries) {
  const auto count = upload_number<std::uint8_t>(sdo, pdo, 0);
  if (!count) {
    return base::Unexpected{count.error()};
  }
  for (unsigned subindex = 1; subindex <= *count; ++subindex) {
    const auto mapping =
        upload_number<std::uint32_t>(sdo, pdo, static_cast<std::uint8_t>(subindex));
    if (!mapping) {
      return base::Unexpected{mapping.error()};
    }
    const std::uint32_t bits = *mapping & 0xFF;
    entries.push_back({.index = static_cast<std::uint16_t>(*mapping >> 16),
                       .subindex = static_cast<std::uint8_t>(*mapping >> 8),
                       .bit_offset = bit_offset,
                       .bit_length = bits});
    bit_offset += bits;
  }
  return bit_offset;
}

/// Reads what the channel's assignment object names. A slave without that object has no process
/// data in this direction.
Result<void> read_channel(SdoClient& sdo, ProcessDataChannel& channel) {
  const auto assignment = static_cast<std::uint16_t>(kAssignment + channel.sync_manager);
  const auto count = upload_number<std::uint8_t>(sdo, assignment, 0);
  if (!count) {
    return does_not_exist(count.error()) ? Result<void>()
                                         : Result<void>(base::Unexpected{count.error()});
  }
  std::uint32_t bits = 0;
  for (unsigned subindex = 1; subindex <= *count; ++subindex) {
    const auto pdo =
        upload_number<std::uint16_t>(sdo, assignment, static_cast<std::uint8_t>(subindex));
    if (!pdo) {
      return base::Unexpected{pdo.error()};
    }
    const auto end = append_pdo(sdo, *pdo, bits, channel.entries);
    if (!end) {
      return base::Unexpected{end.error()};
    }
    bits = *end;
  }
  channel.bytes = (std::size_t{bits} + 7) / 8;
  return {};
}

Result<void> write_sync_manager(Bus& bus, const Station& station,
                                const ProcessDataChannel& channel) {
  std::array<std::byte, registers::kSyncManagerSize> settings{};
  const bool used = channel.bytes != 0;
  base::store_le<std::uint16_t>(settings.data(), channel.settings.start);
  base::store_le<std::uint16_t>(settings.data() + 2, static_cast<std::uint16_t>(channel.bytes));
  settings[4] = static_cast<std::byte>(channel.settings.control);
  settings[6] = used ? std::byte{1} : std::byte{0};
  return bus.write(station, registers::sync_manager(channel.sync_manager, 0), settings);
}

Result<void> write_fmmu(Bus& bus, const Station& station, unsigned number,
                        const ProcessDataChannel& channel, std::size_t logical, std::uint8_t type) {
  std::array<std::byte, registers::kFmmuSize> fmmu{};
  base::store_le<std::uint32_t>(fmmu.data(), static_cast<std::uint32_t>(logical));
  base::store_le<std::uint16_t>(fmmu.data() + 4, static_cast<std::uint16_t>(channel.bytes));
  fmmu[7] = std::byte{7};  // whole bytes: from bit 0 to bit 7
  base::store_le<std::uint16_t>(fmmu.data() + 8, channel.settings.start);
  fmmu[11] = static_cast<std::byte>(type);
  fmmu[12] = std::byte{1};
  return bus.write(
      station, static_cast<std::uint16_t>(registers::kFmmu + number * registers::kFmmuSize), fmmu);
}

}  // namespace

Result<SlaveProcessData> read_process_data(const Station& station,
                                           const SlaveInformation& information, SdoClient* sdo) {
  SlaveProcessData data{.outputs = find_channel(information, kOutputType, kDefaultOutputChannel),
                        .inputs = find_channel(information, kInputType, kDefaultInputChannel)};
  for (ProcessDataChannel* const channel : {&data.outputs, &data.inputs}) {
    if (sdo == nullptr) {
      channel->bytes = channel->settings.length;
    } else if (const auto done = read_channel(*sdo, *channel); !done) {
      return base::Unexpected{done.error()};
    }
    if (channel->bytes != 0 && channel->settings.start == 0) {
      return fail(ErrorCode::configuration, station.name() + " maps process data to sync manager " +
                                                std::to_string(channel->sync_manager) +
                                                ", but its SII gives no address for it");
    }
  }
  return data;
}

Result<ImageLayout> lay_out_image(std::span<const SlaveProcessData> slaves) {
  ImageLayout layout;
  for (const SlaveProcessData& slave : slaves) {
    const std::size_t bytes = slave.outputs.bytes + slave.inputs.bytes;
    if (bytes > kMaximumFrameData) {
      return fail(ErrorCode::configuration,
                  "slave " + std::to_string(layout.parts.size()) + " maps " +
                      std::to_string(bytes) + " bytes of process data, one frame carries " +
                      std::to_string(kMaximumFrameData) + "; assign fewer PDOs");
    }
    if (bytes != 0 &&
        (layout.frames.empty() || layout.frames.back().length + bytes > kMaximumFrameData)) {
      layout.frames.push_back({.start = layout.size});
    }
    layout.parts.push_back({.outputs = layout.size, .inputs = layout.size + slave.outputs.bytes});
    layout.size += bytes;
    if (bytes != 0) {
      ImageLayout::Frame& frame = layout.frames.back();
      frame.length += bytes;
      frame.working_counter =
          static_cast<std::uint16_t>(frame.working_counter + (slave.outputs.bytes != 0 ? 2 : 0) +
                                     (slave.inputs.bytes != 0 ? 1 : 0));
    }
  }
  return layout;
}

Result<void> write_mapping(Bus& bus, const Station& station, const SlaveProcessData& data,
                           const ImageLayout::Part& part) {
  for (const ProcessDataChannel* const channel : {&data.outputs, &data.inputs}) {
    if (auto done = write_sync_manager(bus, station, *channel); !done) {
      return done;
    }
  }
  unsigned fmmu = 0;
  if (data.outputs.bytes != 0) {
    if (auto done = write_fmmu(bus, station, fmmu++, data.outputs, part.outputs, kFmmuWrite);
        !done) {
      return done;
    }
  }
  if (data.inputs.bytes != 0) {
    return write_fmmu(bus, station, fmmu, data.inputs, part.inputs, kFmmuRead);
  }
  return {};
}

}  // namespace stator::master
