#include "stator/imports/resolvers.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <span>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "stator/canopen/eds/eds_file.hpp"
#include "stator/devices/generic/product.hpp"
#include "stator/formats/esi/esi_reader.hpp"
#include "stator/formats/xdd/xdd_reader.hpp"
#include "stator/imports/sii_slave.hpp"

namespace stator::imports {

namespace {

using dictionary::ImportError;
using dictionary::ImportReport;
using product::Product;

constexpr std::array kKinds{std::pair{FileKind::esi, std::string_view("esi")},
                            std::pair{FileKind::sii, std::string_view("sii")},
                            std::pair{FileKind::eds, std::string_view("eds")},
                            std::pair{FileKind::xdd, std::string_view("xdd")}};
/// Longer than any file of a device: more is a mistake.
constexpr std::uintmax_t kLongestFile = std::uintmax_t{256} << 20;

/// "esi:files/drive.xml#EL7211@0x10+module" taken apart.
struct TypeParts {
  FileKind kind{};
  std::string path{};
  formats::EsiChoice choice{};
};

std::optional<TypeParts> parts_of(std::string_view type) {
  for (const auto& [kind, word] : kKinds) {
    if (!type.starts_with(word) || type.size() <= word.size() || type[word.size()] != ':') {
      continue;
    }
    TypeParts parts{.kind = kind};
    std::string_view rest = type.substr(word.size() + 1);
    const std::size_t hash = rest.find('#');
    parts.path = rest.substr(0, hash);
    if (hash != std::string_view::npos) {
      rest = rest.substr(hash + 1);
      std::size_t plus = rest.find('+');
      parts.choice.device = rest.substr(0, plus);
      while (plus != std::string_view::npos) {
        rest = rest.substr(plus + 1);
        plus = rest.find('+');
        parts.choice.modules.emplace_back(rest.substr(0, plus));
      }
    }
    return parts;
  }
  return std::nullopt;
}

base::Expected<std::string, ImportError> content_of(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) {
    return base::Unexpected{ImportError{
        0, "no-file", fmt::format("cannot read {}: {}; name a file", path, error.message())}};
  }
  if (size > kLongestFile) {
    return base::Unexpected{
        ImportError{0, "file-too-long",
                    fmt::format("{} has {} MB; descriptions of devices have less than {}", path,
                                size >> 20, kLongestFile >> 20)}};
  }
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) {
    return base::Unexpected{ImportError{0, "no-file", fmt::format("cannot read {}", path)}};
  }
  return std::move(text).str();
}

template <typename File>
base::Expected<ImportedProduct, ImportError> made(std::string_view type,
                                                  base::Expected<File, ImportError> file,
                                                  ImportReport report) {
  if (!file) {
    return base::Unexpected{file.error()};
  }
  try {
    auto product = devices::imported_product(std::string(type), std::move(file).value(), report);
    return ImportedProduct{std::move(product), std::move(report)};
  } catch (const std::runtime_error& error) {
    return base::Unexpected{ImportError{0, "no-device", error.what()}};
  }
}

/// Products by type, each as long as its file stays as it is.
class Known {
 public:
  std::shared_ptr<const Product> find(std::string_view type) {
    const std::scoped_lock lock(mutex_);
    const Stamp stamp = stamp_of(type);
    const auto known = products_.find(std::string(type));
    if (known != products_.end() && known->second.first == stamp) {
      return known->second.second;
    }
    auto imported = import_product(type);
    if (!imported) {
      const ImportError& error = imported.error();
      throw std::runtime_error(
          error.line != 0 ? fmt::format("line {}: {} [{}]", error.line, error.text, error.rule)
                          : fmt::format("{} [{}]", error.text, error.rule));
    }
    products_.insert_or_assign(std::string(type), std::pair(stamp, imported->product));
    return imported->product;
  }

 private:
  using Stamp = std::pair<std::uintmax_t, std::filesystem::file_time_type>;

  static Stamp stamp_of(std::string_view type) {
    const std::optional<TypeParts> parts = parts_of(type);
    std::error_code ignored;
    return parts ? Stamp{std::filesystem::file_size(parts->path, ignored),
                         std::filesystem::last_write_time(parts->path, ignored)}
                 : Stamp{};
  }

  std::mutex mutex_;
  std::map<std::string, std::pair<Stamp, std::shared_ptr<const Product>>> products_;
};

}  // namespace

std::string_view to_text(FileKind kind) {
  return kKinds[static_cast<std::size_t>(kind)].second;
}

std::optional<FileKind> kind_of(std::string_view content) {
  constexpr std::size_t kEnough = 4096;
  const std::string_view begin = content.substr(0, kEnough);
  const bool binary = begin.find('\0') != std::string_view::npos;
  const bool utf16 = begin.starts_with("\xFF\xFE") || begin.starts_with("\xFE\xFF");
  if (binary && !utf16) {
    return FileKind::sii;
  }
  if (begin.find("ISO15745ProfileContainer") != std::string_view::npos) {
    return FileKind::xdd;
  }
  if (utf16 || begin.find('<') != std::string_view::npos) {
    return FileKind::esi;
  }
  if (begin.find('[') != std::string_view::npos) {
    return FileKind::eds;
  }
  return std::nullopt;
}

base::Expected<ImportedProduct, ImportError> import_product(std::string_view type) {
  const std::optional<TypeParts> parts = parts_of(type);
  if (!parts) {
    return base::Unexpected{ImportError{
        0, "no-kind", fmt::format("\"{}\" names no kind of file: esi:, sii:, eds:, xdd:", type)}};
  }
  auto content = content_of(parts->path);
  if (!content) {
    return base::Unexpected{content.error()};
  }
  ImportReport report;
  switch (parts->kind) {
    case FileKind::esi: {
      auto slave = formats::read_esi(*content, parts->choice, report);
      return made(type, std::move(slave), std::move(report));
    }
    case FileKind::sii: {
      auto slave = slave_of_sii(std::as_bytes(std::span(*content)), report);
      return made(type, std::move(slave), std::move(report));
    }
    case FileKind::eds: {
      auto file = canopen::read_eds(*content, report);
      return made(type, std::move(file), std::move(report));
    }
    case FileKind::xdd: {
      auto file = formats::read_xdd(*content, report);
      return made(type, std::move(file), std::move(report));
    }
  }
  return base::Unexpected{ImportError{}};
}

void add_resolvers(product::Catalogue& catalogue) {
  // One for all catalogues: copies of one are made for every rack.
  static const auto known = std::make_shared<Known>();
  for (const auto& [kind, word] : kKinds) {
    catalogue.add_resolver(std::string(word),
                           [](std::string_view type) { return known->find(type); });
  }
}

}  // namespace stator::imports
