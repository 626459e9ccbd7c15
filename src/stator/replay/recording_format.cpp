#include "stator/replay/recording_format.hpp"

#include "stator/replay/byte_coding.hpp"

namespace stator::replay {

namespace {

void write_texts(ByteWriter& writer, const RecordingHeader::Texts& texts) {
  writer.number(texts.size());
  for (const auto& [name, content] : texts) {
    writer.text(name);
    writer.text(content);
  }
}

void read_texts(ByteReader& reader, RecordingHeader::Texts& texts) {
  for (std::uint64_t rest = reader.number(); rest > 0 && reader.good(); --rest) {
    std::string name = reader.text();
    texts.emplace_back(std::move(name), reader.text());
  }
}

}  // namespace

std::string_view RecordingHeader::option(std::string_view name) const {
  for (const auto& [key, value] : options) {
    if (key == name) {
      return value;
    }
  }
  return {};
}

std::vector<std::byte> encode(const RecordingHeader& header) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  writer.number(header.version);
  writer.text(header.program);
  write_texts(writer, header.options);
  write_texts(writer, header.files);
  writer.number(header.signal_names.size());
  for (const std::string& name : header.signal_names) {
    writer.text(name);
  }
  return bytes;
}

bool decode(const std::vector<std::byte>& bytes, RecordingHeader& header, std::uint64_t& version) {
  ByteReader reader(bytes);
  version = reader.number();
  if (version < kOldestVersion || version > kFormatVersion) {
    return false;
  }
  header.version = version;
  header.program = reader.text();
  read_texts(reader, header.options);
  read_texts(reader, header.files);
  for (std::uint64_t rest = reader.number(); rest > 0 && reader.good(); --rest) {
    header.signal_names.push_back(reader.text());
  }
  return reader.good();
}

}  // namespace stator::replay
