#include "stator/link/system/pcap_writer.hpp"

#include <utility>

namespace stator::link {

namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

// The format of libpcap (pcap-savefile(5)), in the byte order of this machine, which the first word
// tells.

constexpr std::uint32_t kMagicOfNanoseconds = 0xA1B23C4D;
constexpr std::uint16_t kMajorVersion = 2;
constexpr std::uint16_t kMinorVersion = 4;
constexpr std::uint32_t kSnapshotLength = 65535;
constexpr std::uint32_t kLinkTypeEthernet = 1;
constexpr std::uint32_t kLinkTypeSocketCan = 227;

struct FileHeader {
  std::uint32_t magic = kMagicOfNanoseconds;
  std::uint16_t major = kMajorVersion;
  std::uint16_t minor = kMinorVersion;
  std::int32_t time_zone = 0;
  std::uint32_t accuracy = 0;
  std::uint32_t snapshot_length = kSnapshotLength;
  std::uint32_t link_type = 0;
};
static_assert(sizeof(FileHeader) == 24);

struct FrameHeader {
  std::uint32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  std::uint32_t captured = 0;
  std::uint32_t length = 0;
};
static_assert(sizeof(FrameHeader) == 16);

}  // namespace

base::Expected<std::unique_ptr<PcapWriter>, LinkError> PcapWriter::open(const std::string& path,
                                                                        CaptureKind kind) {
  const FileHeader header{.link_type = kind == CaptureKind::ethernet ? kLinkTypeEthernet
                                                                     : kLinkTypeSocketCan};
  auto output = BackgroundOutput::create(path, std::as_bytes(std::span(&header, 1)));
  if (!output) {
    return base::Unexpected{output.error()};
  }
  return std::unique_ptr<PcapWriter>(new PcapWriter(std::move(*output)));
}

bool PcapWriter::write(base::SimTime time, std::span<const std::byte> frame) {
  const auto length = static_cast<std::uint32_t>(frame.size());
  const FrameHeader header{
      .seconds = static_cast<std::uint32_t>(time.nanoseconds() / kNanosecondsPerSecond),
      .nanoseconds = static_cast<std::uint32_t>(time.nanoseconds() % kNanosecondsPerSecond),
      .captured = length,
      .length = length};
  return output_->write(std::as_bytes(std::span(&header, 1)), frame);
}

}  // namespace stator::link
