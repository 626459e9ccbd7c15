// A program at the socket of a chip and its two SPI slaves: any bytes in any pieces, while a master
// and time go on. Every request is answered once, by a reply of its own kind and length or by a
// refusal; what the program asked for last never keeps the chip from the next program.

#include <span>
#include <vector>

#include "input.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"
#include "stator/link/serial/chip_message.hpp"
#include "stator/rack/run/chip_session.hpp"

namespace {

using namespace stator;
using link::ChipMessage;
using link::chip_protocol::Refusal;

constexpr std::size_t kStatus = link::chip_protocol::kStatusLength;

struct Program {
  std::size_t answers = 0;
  std::size_t length = 0;  ///< of the last reply's body
  std::uint8_t kind = 0;
  bool refused = false;
  bool ended = false;

  [[nodiscard]] rack::ChipSession::Output output(devices::Tmc8461& chip, const base::SimTime& now) {
    return {.reply =
                [this](const ChipMessage& message) {
                  ++answers;
                  length = message.body.size();
                  kind = message.kind;
                },
            .event =
                [](const ChipMessage& message) {
                  fuzz::require(message.body.size() == link::chip_protocol::kEventLength);
                  return true;
                },
            .refuse =
                [this](std::uint8_t, Refusal refusal, std::string_view sentence) {
                  ++answers;
                  refused = true;
                  ended = ended || link::chip_protocol::ends_connection(refusal);
                  fuzz::require(!sentence.empty());
                },
            .greeted = [] {},
            .power = [&chip, &now](bool on) { chip.set_power(on, now); }};
  }
};

void take(rack::ChipSession& session, Program& program, const ChipMessage& message,
          base::SimTime now) {
  const std::size_t before = program.answers;
  program.refused = false;
  session.take(message, now);
  fuzz::require(program.answers == before + 1);
  if (program.refused) {
    return;
  }
  fuzz::require(program.kind == (message.kind | link::chip_protocol::kReply));
  if (message.kind == static_cast<std::uint8_t>(link::chip_protocol::Request::transfer)) {
    fuzz::require(program.length ==
                  kStatus + message.body.size() - link::chip_protocol::kTransferPrefix);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input({data, size});
  devices::Tmc8461Configuration configuration;
  const unsigned options = input.byte();
  configuration.device_emulation = (options & 1U) != 0;
  configuration.shared_bus = (options & 2U) != 0;
  configuration.reset_loop = (options & 4U) != 0;
  devices::Tmc8461 chip(configuration);
  base::SimTime now;
  Program program;
  rack::ChipSession session(chip, "chip", program.output(chip, now));
  session.begin();
  link::ChipMessageReader reader;
  const std::vector<std::byte> hello{std::byte{'S'}, std::byte{'T'}, std::byte{'C'}, std::byte{'H'},
                                     std::byte{1}};
  take(session, program, {.kind = 1, .tag = 0, .body = hello}, now);
  while (!input.empty() && !program.ended && !reader.broken()) {
    std::vector<std::byte> piece(input.byte());
    input.fill(piece);
    for (std::span<const std::byte> rest(piece); !rest.empty();) {
      const std::span<std::byte> space = reader.space();
      const std::size_t length = std::min(space.size(), rest.size());
      std::copy_n(rest.begin(), length, space.begin());
      reader.received(length);
      rest = rest.subspan(length);
      while (!program.ended) {
        const auto message = reader.next();
        if (!message) {
          break;
        }
        take(session, program, *message, now);
      }
      if (program.ended || reader.broken()) {
        break;
      }
    }
    now += base::SimDuration(std::int64_t{input.word()} * 50);
    chip.advance(now);
    chip.handle_bus_events(now);
  }
  session.leave();
  program.ended = false;
  session.begin();
  take(session, program, {.kind = 1, .tag = 0, .body = hello}, now);
  fuzz::require(!program.refused);
  return 0;
}
