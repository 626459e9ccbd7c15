// Commands to a TMCL module over a CAN bus: one frame out, one frame back, events passed over.
#include <array>
#include <chrono>
#include <deque>

#include <fmt/format.h>
#include <poll.h>

#include "stator/can/frame.hpp"
#include "stator/link/can/can_link.hpp"
#include "stator/tmcl_tools/failure.hpp"
#include "stator/tmcl_tools/tmcl_connection.hpp"

namespace stator::tmcl_tools {

namespace {

using Clock = std::chrono::steady_clock;

class CanConnection final : public TmclConnection {
 public:
  CanConnection(std::unique_ptr<link::CanLink> link, const TmclHostOptions& options)
      : link_(std::move(link)), options_(options) {}

  base::Expected<TmclReply, Error> execute(const tmcl::Instruction& instruction) override {
    const tmcl::Telegram telegram = tmcl::encode(tmcl::Request{.address = options_.module_address,
                                                               .command = instruction.command,
                                                               .type = instruction.type,
                                                               .motor = instruction.motor,
                                                               .value = instruction.value});
    link_->send(can::data_frame(options_.can_id, std::span(telegram).subspan(1)), now());
    link_->flush();
    if (!has_reply(instruction)) {
      return TmclReply{};
    }
    const Clock::time_point end =
        Clock::now() + std::chrono::nanoseconds(options_.timeout.nanoseconds());
    while (const auto frame = next_frame(end)) {
      if (!is_event(*frame)) {
        return reply_in(frame->payload(), instruction);
      }
      ++events_;
    }
    return base::Unexpected{fmt::format(
        "no reply with identifier {:x}h came in {:g} s; is the module running, are its identifiers "
        "{:x}h and {:x}h?",
        options_.can_reply_id, options_.timeout.seconds(), options_.can_id, options_.can_reply_id)};
  }

  bool pass(base::SimDuration duration) override {
    const Clock::time_point end = Clock::now() + std::chrono::nanoseconds(duration.nanoseconds());
    while (const auto frame = next_frame(end)) {
      events_ += is_event(*frame) ? 1 : 0;
    }
    return std::exchange(events_, 0) != 0;
  }
  base::Expected<void, Error> set_input(const std::string& /*assignment*/) override {
    return base::Unexpected{
        std::string("what is around a module is out of reach over its bus; a rack file's "
                    "[[event]] sets it")};
  }
  [[nodiscard]] std::string name() const override { return link_->name(); }

 private:
  static bool is_event(const can::Frame& frame) {
    return frame.data[1] == static_cast<std::byte>(tmcl::Status::target_reached);
  }

  [[nodiscard]] base::SimTime now() const {
    return base::SimTime(base::SimDuration(
        std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start_).count()));
  }

  /// The next frame of the module; nothing: none came in time.
  std::optional<can::Frame> next_frame(Clock::time_point end) {
    while (true) {
      while (!received_.empty()) {
        const can::Frame frame = received_.front();
        received_.pop_front();
        if (!frame.extended && !frame.remote && frame.identifier == options_.can_reply_id) {
          return frame;
        }
      }
      std::array<can::Frame, 64> frames;
      const auto count = link_->receive(frames, now());
      if (!count) {
        throw Failure(count.error().text);
      }
      received_.insert(received_.end(), frames.begin(),
                       frames.begin() + static_cast<std::ptrdiff_t>(*count));
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
      if (received_.empty()) {
        pollfd waiting{.fd = link_->descriptor(), .events = POLLIN, .revents = 0};
        if (left.count() <= 0 || ::poll(&waiting, 1, static_cast<int>(left.count())) == 0) {
          return std::nullopt;
        }
      }
    }
  }

  std::unique_ptr<link::CanLink> link_;
  TmclHostOptions options_;
  std::deque<can::Frame> received_;
  unsigned events_ = 0;
  Clock::time_point start_ = Clock::now();
};

}  // namespace

std::unique_ptr<TmclConnection> connect_tmcl_can(const std::string& port,
                                                 const TmclHostOptions& options) {
  auto link = link::open_can_link(port);
  if (!link) {
    throw Failure(link.error().text);
  }
  return std::make_unique<CanConnection>(*std::move(link), options);
}

}  // namespace stator::tmcl_tools
