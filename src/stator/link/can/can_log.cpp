#include "stator/link/can/can_log.hpp"

#include <array>
#include <utility>

#include <arpa/inet.h>

#include "stator/link/can/hexadecimal.hpp"
#include "stator/link/can/socketcan_frame.hpp"

namespace stator::link {

namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

std::string line_begin(base::SimTime time, const std::string& interface) {
  std::array<char, 48> text{};
  const int length =
      std::snprintf(text.data(), text.size(), "(%010lld.%06lld) ",
                    static_cast<long long>(time.nanoseconds() / kNanosecondsPerSecond),
                    static_cast<long long>(time.nanoseconds() % kNanosecondsPerSecond / 1'000));
  return std::string(text.data(), static_cast<std::size_t>(length)) + interface + ' ';
}

void append_data(std::string& line, std::span<const std::byte> data) {
  for (const std::byte each : data) {
    append_hexadecimal(line, std::to_integer<unsigned>(each), 2);
  }
}

/// The packet of LINKTYPE_CAN_SOCKETCAN: Linux's can_frame with the identifier in network order, as
/// long as its data.
bool write_packet(PcapWriter& writer, base::SimTime time, const can_frame& frame,
                  std::size_t data) {
  can_frame packet = frame;
  packet.can_id = htonl(frame.can_id);
  return writer.write(time,
                      std::as_bytes(std::span(&packet, 1)).first(offsetof(can_frame, data) + data));
}

}  // namespace

std::string candump_line(base::SimTime time, const std::string& interface,
                         const can::Frame& frame) {
  std::string line = line_begin(time, interface);
  append_hexadecimal(line, frame.identifier, frame.extended ? 8 : 3);
  line += '#';
  if (frame.remote) {
    line += 'R';
    if (frame.length > 0) {
      append_hexadecimal(line, frame.length, 1);
    }
  }
  append_data(line, frame.payload());
  return line;
}

std::string candump_line(base::SimTime time, const std::string& interface,
                         const ErrorFrame& error) {
  std::string line = line_begin(time, interface);
  append_hexadecimal(line, CAN_ERR_FLAG | error.classes, 8);
  line += '#';
  append_data(line, error.data);
  return line;
}

base::Expected<std::unique_ptr<CandumpLog>, LinkError> CandumpLog::open(
    const std::string& path, const std::string& interface) {
  auto output = BackgroundOutput::create(path);
  if (!output) {
    return base::Unexpected{output.error()};
  }
  return std::unique_ptr<CandumpLog>(new CandumpLog(interface, std::move(*output)));
}

bool CandumpLog::write(base::SimTime time, const can::Frame& frame) {
  return output_->write(candump_line(time, interface_, frame) + '\n');
}

bool CandumpLog::write(base::SimTime time, const ErrorFrame& error) {
  return output_->write(candump_line(time, interface_, error) + '\n');
}

base::Expected<std::unique_ptr<CanCapture>, LinkError> CanCapture::open(const std::string& path) {
  auto writer = PcapWriter::open(path, CaptureKind::socketcan);
  if (!writer) {
    return base::Unexpected{writer.error()};
  }
  return std::unique_ptr<CanCapture>(new CanCapture(std::move(*writer)));
}

bool CanCapture::write(base::SimTime time, const can::Frame& frame) {
  return write_packet(*writer_, time, to_socketcan(frame), frame.payload().size());
}

bool CanCapture::write(base::SimTime time, const ErrorFrame& error) {
  return write_packet(*writer_, time, to_socketcan(error), error.data.size());
}

}  // namespace stator::link
