#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stator/link/can/can_link.hpp"
#include "stator/link/can/can_stream_session.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {

/// What all ports over streams of characters have in common: programs, each with a session and
/// buffers of its own, behind one epoll descriptor.
class CanStreamLink : public CanLink {
 public:
  [[nodiscard]] int descriptor() const final { return waiting_.get(); }
  base::Expected<std::size_t, LinkError> receive(std::span<can::Frame> frames,
                                                 base::SimTime now) final;
  void send(const can::Frame& frame, base::SimTime time) final;
  void send_error(const ErrorFrame& error, base::SimTime time) final;
  void flush() final;
  [[nodiscard]] CanLinkStatistics statistics() const final;
  [[nodiscard]] const std::string& name() const final { return name_; }

 protected:
  enum class Medium : std::uint8_t { terminal, socket };

  struct Client {
    FileDescriptor descriptor;
    std::unique_ptr<CanStreamSession> session;
    std::string input;
    std::size_t input_taken = 0;
    std::string output;
    std::size_t output_sent = 0;
    bool waits_to_write = false;
    bool ended = false;  ///< its end of the stream is closed; what it sent is still to be taken
  };

  CanStreamLink(Medium medium, const CanLinkOptions& options)
      : medium_(medium), options_(options) {}

  /// To be called once before anything else.
  base::Expected<void, LinkError> prepare(std::string name);
  /// Calls on_readable() when `descriptor` is.
  base::Expected<void, LinkError> watch(int descriptor);
  virtual void on_readable(int descriptor) = 0;
  /// All that programs sent has been taken.
  virtual void on_idle() {}
  /// Has read from `client`.
  virtual void on_read(Client& /*client*/) {}
  base::Expected<void, LinkError> add_client(FileDescriptor descriptor,
                                             std::unique_ptr<CanStreamSession> session);
  /// Resets the session of `client`, whose input has been taken, for another program that uses the
  /// same stream.
  void restart_client(Client& client);
  [[nodiscard]] const std::vector<std::unique_ptr<Client>>& clients() const { return clients_; }
  [[nodiscard]] const CanLinkOptions& options() const { return options_; }
  /// The time that receive() was told last.
  [[nodiscard]] base::SimTime now() const { return now_; }

 private:
  /// Frames on their way to receive()'s caller.
  struct Target {
    std::span<can::Frame> frames;
    std::size_t count = 0;
    [[nodiscard]] bool full() const { return count == frames.size(); }
  };

  void service(int descriptor, std::uint32_t events, Target& target);
  void take_from_all(Target& target);
  void take_from(Client& client, Target& target);
  void deliver(const can::Frame& frame, Client& from, Target& target);
  void advance_sessions(Target& target);
  void set_timer();
  void read(Client& client);
  void write(Client& client);
  void wait_to_write(Client& client, bool wait);
  static void discard_output(Client& client);
  static void restart_output(Client& client, std::size_t answered);
  void put(Client& client, const can::Frame& frame, base::SimTime time);
  void end(Client& client);
  void remove_ended(bool all_taken);
  [[nodiscard]] Client* find(int descriptor);

  Medium medium_;
  CanLinkOptions options_;
  std::string name_;
  FileDescriptor waiting_;
  FileDescriptor timer_;
  std::optional<MachineTime> timer_set_to_;
  std::vector<std::unique_ptr<Client>> clients_;
  base::SimTime now_;
  CanLinkStatistics statistics_;
};

}  // namespace stator::link
