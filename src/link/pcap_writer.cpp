#include "link/pcap_writer.hpp"

#include <cerrno>
#include <cstring>

#include <pcap/pcap.h>

namespace stator::link {

namespace {

constexpr int kSnapshotLength = 65535;
constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

LinkError file_error(const std::string& path, const std::string& what, int error) {
  return {LinkErrorCode::file,
          "cannot " + what + " capture file \"" + path + "\": " + std::strerror(error)};
}

}  // namespace

struct PcapWriter::File {
  pcap_t* format = nullptr;
  pcap_dumper_t* dump = nullptr;

  File() = default;
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    if (dump != nullptr) {
      pcap_dump_close(dump);
    }
    if (format != nullptr) {
      pcap_close(format);
    }
  }
};

PcapWriter::PcapWriter(std::string path, std::unique_ptr<File> file)
    : path_(std::move(path)), file_(std::move(file)) {}

PcapWriter::~PcapWriter() = default;

base::Expected<std::unique_ptr<PcapWriter>, LinkError> PcapWriter::open(const std::string& path,
                                                                        CaptureKind kind) {
  auto file = std::make_unique<File>();
  file->format = pcap_open_dead_with_tstamp_precision(
      kind == CaptureKind::ethernet ? DLT_EN10MB : DLT_CAN_SOCKETCAN, kSnapshotLength,
      PCAP_TSTAMP_PRECISION_NANO);
  std::FILE* const stream = std::fopen(path.c_str(), "wb");
  if (stream == nullptr) {
    return base::Unexpected{file_error(path, "create", errno)};
  }
  file->dump = pcap_dump_fopen(file->format, stream);
  if (file->dump == nullptr) {
    const int error = errno;
    std::fclose(stream);
    return base::Unexpected{file_error(path, "write", error)};
  }
  if (pcap_dump_flush(file->dump) != 0) {
    return base::Unexpected{file_error(path, "write", errno)};
  }
  return std::unique_ptr<PcapWriter>(new PcapWriter(path, std::move(file)));
}

base::Expected<void, LinkError> PcapWriter::write(base::SimTime time,
                                                  std::span<const std::byte> frame) {
  pcap_pkthdr header{};
  header.ts.tv_sec = static_cast<time_t>(time.nanoseconds() / kNanosecondsPerSecond);
  // With nanosecond precision libpcap takes nanoseconds in the field named for microseconds.
  header.ts.tv_usec = static_cast<suseconds_t>(time.nanoseconds() % kNanosecondsPerSecond);
  header.caplen = static_cast<bpf_u_int32>(frame.size());
  header.len = header.caplen;
  errno = 0;
  pcap_dump(reinterpret_cast<u_char*>(file_->dump), &header,
            reinterpret_cast<const u_char*>(frame.data()));
  if (pcap_dump_flush(file_->dump) != 0 || std::ferror(pcap_dump_file(file_->dump)) != 0) {
    return base::Unexpected{file_error(path_, "write", errno != 0 ? errno : EIO)};
  }
  ++frames_written_;
  return {};
}

}  // namespace stator::link
