#include "stator/replay/recorded_files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace stator::replay {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRackFolder = "rack/";
constexpr std::string_view kStateFolder = "state/";

std::string content_of(const fs::path& path) {
  if (std::error_code ignored; fs::is_directory(path, ignored)) {
    throw std::runtime_error(
        fmt::format("cannot read {}: it is a directory; name a file in it", path.string()));
  }
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  if (file) {
    content << file.rdbuf();
  }
  if (!file || content.bad()) {
    throw std::runtime_error(
        fmt::format("cannot read {}: {}", path.string(), std::generic_category().message(errno)));
  }
  return content.str();
}

/// Files that a rack file names, from the rack file's folder.
std::vector<fs::path> paths_of(const std::vector<std::string>& named_files) {
  std::vector<fs::path> paths;
  for (const std::string& name : named_files) {
    paths.push_back(fs::path(name).lexically_normal());
    if (paths.back().is_absolute()) {
      throw std::runtime_error(fmt::format(
          "a recording keeps the files that the rack file names, and \"{}\" would lie elsewhere on "
          "another machine; name it as it lies beside the rack file",
          name));
    }
  }
  return paths;
}

/// The innermost folders of `folder`, the absolute path of the rack file's folder: as many as
/// `paths` climb by "..". With them in front, all paths stay below the folder of the recording.
/// Empty if none climbs.
fs::path kept_folder(const fs::path& folder, const std::vector<fs::path>& paths) {
  std::ptrdiff_t most = 0;
  for (const fs::path& path : paths) {
    most = std::max(most, std::ranges::count(path, fs::path("..")));
  }
  fs::path around = folder.lexically_normal();
  if (!around.has_filename()) {
    around = around.parent_path();  // "racks/" has an empty last part
  }
  fs::path kept;
  for (; most > 0; --most) {
    kept = around.filename() / kept;
    around = around.parent_path();
  }
  return kept;
}

void write_below(const fs::path& folder, const std::string& name, const std::string& content) {
  const fs::path path = fs::path(name).lexically_normal();
  if (path.empty() || path.is_absolute() || *path.begin() == "..") {
    throw std::runtime_error(
        fmt::format("the recording holds a file \"{}\" that would lie elsewhere", name));
  }
  std::error_code error;
  fs::create_directories((folder / path).parent_path(), error);
  std::ofstream file(folder / path, std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.flush();
  if (!file) {
    throw std::runtime_error(
        fmt::format("cannot write {}: {}; choose a file in a directory that exists and "
                    "can be written",
                    (folder / path).string(), std::generic_category().message(errno)));
  }
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "stator-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error(
        fmt::format("cannot make a folder like \"{}\"; is the disk full?", name));
  }
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  fs::remove_all(path_, error);
}

void keep_rack(const fs::path& rack, const std::vector<std::string>& named_files,
               RecordingHeader& header) {
  keep_rack(rack, content_of(rack), named_files, header);
}

void keep_rack(const fs::path& rack, std::string content,
               const std::vector<std::string>& named_files, RecordingHeader& header) {
  const std::vector<fs::path> paths = paths_of(named_files);
  const fs::path folder = kept_folder(fs::absolute(rack).parent_path(), paths);
  const auto keep = [&](const fs::path& path, std::string kept) {
    std::string name = (folder / path).lexically_normal().generic_string();
    header.files.emplace_back(std::string(kRackFolder) + name, std::move(kept));
    return name;
  };
  header.options.emplace_back(kRackOption, keep(rack.filename(), std::move(content)));
  for (const fs::path& path : paths) {
    keep(path, content_of(rack.parent_path() / path));
  }
}

void keep_state(const fs::path& directory, RecordingHeader& header) {
  header.options.emplace_back(kStateOption, kStateKept);
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory, error)) {
    if (entry.is_regular_file() && !entry.path().filename().string().starts_with('.')) {
      header.files.emplace_back(std::string(kStateFolder) + entry.path().filename().string(),
                                content_of(entry.path()));
    }
  }
}

std::string lay_out(const RecordingHeader& header, const fs::path& folder, const fs::path& state) {
  for (const auto& [name, content] : header.files) {
    if (name.starts_with(kStateFolder)) {
      if (!state.empty()) {
        write_below(state, name.substr(kStateFolder.size()), content);
      }
    } else {
      write_below(folder, name, content);
    }
  }
  const std::string_view rack = header.option(kRackOption);
  return rack.empty() ? std::string() : (folder / kRackFolder / rack).string();
}

}  // namespace stator::replay
