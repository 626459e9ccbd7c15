#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stator/product/device/signal.hpp"
#include "stator/rack/core/command.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/observe/journal.hpp"
#include "stator/replay/byte_coding.hpp"
#include "stator/replay/recording_file.hpp"

namespace stator::replay {

/// A moment of a recording that somebody gave a name.
struct Mark {
  std::string name;
  base::SimTime time;
};

/// Keeps everything that is done to a rack in a recording, with what the rack gives out and the
/// values of its signals every kSignalPeriod.
class SessionRecorder final : public rack::Journal {
 public:
  static constexpr base::SimDuration kSignalPeriod{100'000'000};
  /// Simulated time after which what was recorded goes to the file.
  static constexpr base::SimDuration kChunkTime{100'000'000};

  /// Records `rack`, at power-on, into a new file at `path`; `header` lacks the signals' names
  /// only. Ports that programs have on its buses already belong to the recording. Throws
  /// std::runtime_error when the file cannot be created. The rack outlives the
  /// recorder, which has to be finished or destroyed while nobody uses the rack.
  SessionRecorder(rack::Rack& rack, const std::string& path, RecordingHeader header);
  ~SessionRecorder() override;

  /// Gives the present moment a name.
  void mark(const std::string& name) { rack_.execute({rack::command::Mark{name}}); }
  [[nodiscard]] const std::vector<Mark>& marks() const { return marks_; }

  /// Ends the recording for whoever holds the rack, which goes on and no longer calls the recorder;
  /// what is not in the file yet is on its way. finish() is due nevertheless.
  void end();
  /// Ends the recording, if end() has not, and waits for the disk, as
  /// link::BackgroundOutput::finish() does; afterwards the rack no longer calls the recorder.
  /// `asked`: when the end was asked for, from which on waiting is limited.
  void finish(
      link::BackgroundOutput::Clock::time_point asked = link::BackgroundOutput::Clock::now());
  /// Where the recording ends if the disk was too slow or full; never if it did not.
  [[nodiscard]] base::SimTime broken_off() const { return broken_off_; }
  [[nodiscard]] base::SimTime time() const { return time_; }
  [[nodiscard]] std::uint64_t bytes() const { return file_.bytes(); }
  [[nodiscard]] const std::string& path() const { return path_; }

  void command(const rack::Command& command) override;
  void advanced(base::SimTime now) override;
  void frame_comes(std::size_t segment, ethercat::MasterInterface entry, base::SimTime arrival,
                   std::span<const std::byte> frame) override;
  void frame_leaves(std::optional<ethercat::MasterInterface> exit,
                    std::span<const std::byte> frame) override;
  void port_opened(std::size_t bus, std::size_t port, bool hears_errors, bool lossy) override;
  void port_closes(std::size_t bus, std::size_t port) override;
  void can_frame_leaves(std::size_t bus, std::size_t port, const can::TimedFrame& frame) override;
  void bytes_leave(std::size_t line, std::span<const std::byte> bytes) override;
  void host_spi_answers(std::span<const std::byte> miso) override;
  void eoe_frame_leaves(rack::DeviceAddress device, std::span<const std::byte> frame) override;

 private:
  // Each records one kind of command as a step.
  void record(const rack::command::Advance& command);
  void record(const rack::command::TakeBusEvents& command);
  void record(const rack::command::SetCarrier& command);
  void record(const rack::command::ReleaseFrame& command);
  void record(const rack::command::PutCanFrame& command);
  void record(const rack::command::ReplacePorts& command);
  void record(const rack::command::PutBytes& command);
  void record(const rack::command::ApplyEvent& command);
  void record(const rack::command::InjectFault& command);
  void record(const rack::command::ClearFault& command);
  void record(const rack::command::ReadObject& command);
  void record(const rack::command::WriteObject& command);
  void record(const rack::command::CompleteStorage& command);
  void record(const rack::command::SelectHostSpi& command);
  void record(const rack::command::TransferHostSpi& command);
  void record(const rack::command::DeselectHostSpi& command);
  void record(const rack::command::SetHostPin& command);
  void record(const rack::command::PutEoeFrame& command);
  void record(const rack::command::Mark& command);

  /// Opens a step of `content` bytes at most beside its numbers. False: the recording has ended.
  bool begin(StepKind kind, std::size_t content = 0);
  void time(base::SimTime now);
  void flush();
  void record_signals();
  [[nodiscard]] ByteWriter writer() { return ByteWriter(*chunk_); }

  rack::Rack& rack_;
  std::string path_;
  std::vector<product::Signal> signals_;
  std::vector<std::uint64_t> values_;  ///< bits of the signals as recorded last
  bool records_ports_;                 ///< the format has steps for them
  RecordingFile file_;
  RecordingFile::Chunk* chunk_ = nullptr;
  base::SimTime time_;
  base::SimTime chunk_began_;
  base::SimTime next_signals_;
  base::SimTime broken_off_ = base::SimTime::never();
  bool ended_ = false;
  bool finished_ = false;
  std::vector<std::vector<std::byte>> last_frames_;  ///< by segment: the request before
  std::vector<std::byte> request_;                   ///< what frame_leaves() belongs to
  std::vector<Mark> marks_;
};

/// The names of all signals, for a header.
[[nodiscard]] std::vector<std::string> names_of(const std::vector<product::Signal>& signals);

}  // namespace stator::replay
