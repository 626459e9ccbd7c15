#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stator/base/byte_order.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/master/al_control.hpp"
#include "stator/master/cycle_statistics.hpp"
#include "stator/master/error.hpp"
#include "stator/master/frame_port.hpp"
#include "stator/master/mapped_entry.hpp"
#include "stator/master/master_options.hpp"
#include "stator/master/sdo_types.hpp"
#include "stator/master/slave.hpp"

namespace stator::master {

/// A small EtherCAT master: finds the slaves of a segment, brings them to Operational, exchanges
/// process data and reads and writes objects. It knows the protocol and no device.
///
/// Blocking and single-threaded; all time comes from the port. Slaves are named by their position
/// (0 = first); a position that does not exist is ErrorCode::argument.
class Master {
 public:
  /// `port` must outlive the master.
  explicit Master(FramePort& port, const MasterOptions& options = {});
  /// One that knows what `other` knows of the segment, and goes on from there when the segment is
  /// as it was then.
  Master(FramePort& port, const Master& other);
  Master(Master&& other) noexcept;
  Master& operator=(Master&& other) noexcept;
  ~Master();

  /// Counts the slaves, sets all of them to Init, gives station addresses from 1001h and reads who
  /// they are. What an earlier scan found and configured is forgotten.
  Result<void> scan();
  [[nodiscard]] const std::vector<Slave>& slaves() const;

  /// Reads the slave's present state.
  Result<AlStatus> al_status(std::size_t position);
  /// The AL status registers of all slaves that answer, one ORed with the other: what a master
  /// looks at in each cycle to see whether any has left its state.
  Result<std::uint16_t> al_status_of_all();
  /// Reads registers or memory of the slave's controller from `address` on.
  Result<void> read_registers(std::size_t position, std::uint16_t address,
                              std::span<std::byte> out);
  /// Requests one state and waits for it; an error the slave still indicates is acknowledged first.
  Result<void> request_state(std::size_t position, ethercat::AlState state);

  /// Sets up the mailbox from the slave's SII and goes from Init to Pre-Operational. Does nothing
  /// when the slave is beyond Init already.
  Result<void> start_mailbox(std::size_t position);

  /// For all slaves: start_mailbox, then reads the PDO mapping the slave has (1C12h, 1C13h and the
  /// PDOs named there), sets sync managers and FMMUs for it and goes to Safe-Operational.
  Result<void> configure_process_data();
  /// The same for the slaves at `positions` alone: the others stay in the state they are in and
  /// have no process data, and go_operational() leaves them out.
  Result<void> configure_process_data(std::span<const std::size_t> positions);
  /// That has been done since the last scan, so run_cycle() exchanges.
  [[nodiscard]] bool process_data_configured() const;

  /// From Safe-Operational to Operational, process data running meanwhile.
  Result<void> go_operational();

  /// Whether go_operational() has succeeded and the outputs take effect.
  [[nodiscard]] bool operational() const;

  /// Ends the process data exchange and requests Init from all slaves, without waiting for them.
  Result<void> stop();

  /// Measures propagation delays and sets the system time offsets of all slaves with distributed
  /// clocks, so that their system times agree with that of the first of them (ETG.1000.4 §6.2).
  Result<void> synchronize_clocks();

  /// Sends the outputs and fetches the inputs once. ErrorCode::timeout: the frame was lost;
  /// ErrorCode::working_counter: not every slave took part. The inputs then stay as they were.
  Result<void> exchange_process_data();

  /// Waits for the next multiple of the cycle time and exchanges process data. Single lost cycles
  /// are counted and tolerated. Without configured process data it only waits.
  Result<void> run_cycle();
  [[nodiscard]] const CycleStatistics& cycle_statistics() const;

  /// The slave's part of the process image; empty before configure_process_data().
  [[nodiscard]] std::span<std::byte> outputs(std::size_t position);
  [[nodiscard]] std::span<const std::byte> inputs(std::size_t position) const;
  [[nodiscard]] std::span<const MappedEntry> output_entries(std::size_t position) const;
  [[nodiscard]] std::span<const MappedEntry> input_entries(std::size_t position) const;

  /// Reads an object by SDO, whatever its length; the mailbox must have been started.
  Result<std::vector<std::byte>> upload(std::size_t position, ObjectAddress object);
  /// Writes an object by SDO.
  Result<void> download(std::size_t position, ObjectAddress object,
                        std::span<const std::byte> data);

  /// upload() of a number; an object of another length is ErrorCode::protocol.
  template <typename T>
  Result<T> upload_number(std::size_t position, ObjectAddress object);
  /// download() of a number.
  template <typename T>
  Result<void> download_number(std::size_t position, ObjectAddress object, T value);

  /// What the slave's dictionary contains, by the SDO information service.
  Result<std::vector<std::uint16_t>> object_list(std::size_t position,
                                                 ObjectListType type = ObjectListType::all);
  Result<ObjectDescription> object_description(std::size_t position, std::uint16_t index);
  Result<EntryDescription> entry_description(std::size_t position, std::uint16_t index,
                                             std::uint8_t subindex);

  /// Fetches emergencies the slave has ready and those that came in meanwhile, oldest first.
  Result<std::vector<Emergency>> take_emergencies(std::size_t position);

  [[nodiscard]] FramePort& port();
  [[nodiscard]] const MasterOptions& options() const;

 private:
  struct State;

  Error wrong_length(std::size_t position, ObjectAddress object, std::size_t expected,
                     std::size_t actual) const;

  std::unique_ptr<State> state_;
};

template <typename T>
Result<T> Master::upload_number(std::size_t position, ObjectAddress object) {
  const auto data = upload(position, object);
  if (!data) {
    return base::Unexpected{data.error()};
  }
  if (data->size() != sizeof(T)) {
    return base::Unexpected{wrong_length(position, object, sizeof(T), data->size())};
  }
  return base::load_le<T>(data->data());
}

template <typename T>
Result<void> Master::download_number(std::size_t position, ObjectAddress object, T value) {
  std::array<std::byte, sizeof(T)> data;
  base::store_le<T>(data.data(), value);
  return download(position, object, data);
}

}  // namespace stator::master
