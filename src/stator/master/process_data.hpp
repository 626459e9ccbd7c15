#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/master/bus.hpp"
#include "stator/master/mapped_entry.hpp"
#include "stator/master/sdo_client.hpp"
#include "stator/master/slave.hpp"

namespace stator::master {

/// One direction of a slave's process data: the sync manager that carries them and what they are.
struct ProcessDataChannel {
  unsigned sync_manager = 0;
  ethercat::SiiSyncManager settings;  ///< start address and control byte
  std::vector<MappedEntry> entries;   ///< empty if the slave has no object dictionary
  std::size_t bytes = 0;
};

/// What one slave exchanges cyclically.
struct SlaveProcessData {
  ProcessDataChannel outputs;
  ProcessDataChannel inputs;
};

/// Finds out what a slave exchanges: the sync managers from its SII, the length from the PDOs that
/// 1C12h and 1C13h assign (ETG.1000.6 §5.6.7.4) or, without CoE (`sdo` null), from the SII.
[[nodiscard]] Result<SlaveProcessData> read_process_data(const Station& station,
                                                         const SlaveInformation& information,
                                                         SdoClient* sdo);

/// Where the process data of all slaves lie in the process image, and the frames that carry it.
/// Outputs and inputs of one slave are neighbours in one frame, so a frame's working counter is
/// known: 2 for each slave with outputs, 1 more for each with inputs.
struct ImageLayout {
  struct Part {
    std::size_t outputs = 0;  ///< offsets in the image, which are also logical addresses
    std::size_t inputs = 0;
  };
  struct Frame {
    std::size_t start = 0;
    std::size_t length = 0;
    std::uint16_t working_counter = 0;
  };
  std::vector<Part> parts;  ///< by slave
  std::vector<Frame> frames;
  std::size_t size = 0;
};

/// Lays out the image. ErrorCode::configuration if one slave's process data exceed a frame.
[[nodiscard]] Result<ImageLayout> lay_out_image(std::span<const SlaveProcessData> slaves);

/// Writes one slave's process data sync managers and FMMUs; to be done in Pre-Operational.
[[nodiscard]] Result<void> write_mapping(Bus& bus, const Station& station,
                                         const SlaveProcessData& data,
                                         const ImageLayout::Part& part);

}  // namespace stator::master
