#include "stator/cli/run/session_files.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/cli/files.hpp"
#include "stator/cli/program_version.hpp"

namespace stator::cli {

namespace {

namespace fs = std::filesystem;
using replay::RecordingHeader;

constexpr std::string_view kRackFolder = "rack/";
constexpr std::string_view kStateFolder = "state/";

/// The options that decide what a rack does, in both directions.
template <typename Options, typename Text, typename List>
void for_each_option(Options& options, const Text& text, const List& list) {
  text("device", options.device);
  text("link", options.link);
  text("spi", options.spi);
  text("bit-rate", options.bit_rate);
  text("redundant", options.redundant);
  text("clock", options.clock);
  list("port", options.ports);
  list("serial", options.serial);
  list("set", options.changes);
}

/// Files that a rack file names, from the rack file's folder.
std::vector<fs::path> paths_of(const std::vector<std::string>& named_files) {
  std::vector<fs::path> paths;
  for (const std::string& name : named_files) {
    paths.push_back(fs::path(name).lexically_normal());
    if (paths.back().is_absolute()) {
      throw Failure(fmt::format(
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

/// Puts a rack file and the files it names into `header`, with their places relative to each other.
void keep_rack(const fs::path& rack, const std::vector<std::string>& named_files,
               RecordingHeader& header) {
  const std::vector<fs::path> paths = paths_of(named_files);
  const fs::path folder = kept_folder(fs::absolute(rack).parent_path(), paths);
  const auto keep = [&](const fs::path& path, std::string content) {
    std::string name = (folder / path).lexically_normal().generic_string();
    header.files.emplace_back(std::string(kRackFolder) + name, std::move(content));
    return name;
  };
  header.options.emplace_back("rack", keep(rack.filename(), read_file(rack.string())));
  for (const fs::path& path : paths) {
    keep(path, read_file((rack.parent_path() / path).string()));
  }
}

void write_below(const fs::path& folder, const std::string& name, const std::string& content) {
  const fs::path path = fs::path(name).lexically_normal();
  if (path.empty() || path.is_absolute() || *path.begin() == "..") {
    throw Failure(fmt::format("the recording holds a file \"{}\" that would lie elsewhere", name));
  }
  std::error_code error;
  fs::create_directories((folder / path).parent_path(), error);
  write_file((folder / path).string(), content);
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "stator-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw Failure(fmt::format("cannot make a folder like \"{}\"; is the disk full?", name));
  }
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  fs::remove_all(path_, error);
}

RecordingHeader header_of(const RunOptions& options, const rack::RackConfiguration& configuration) {
  RecordingHeader header;
  header.program = program_version();
  const auto keep = [&header](const char* name, const std::string& value) {
    if (!value.empty()) {
      header.options.emplace_back(name, value);
    }
  };
  for_each_option(options, keep, [&](const char* name, const std::vector<std::string>& values) {
    for (const std::string& value : values) {
      keep(name, value);
    }
  });
  keep("count", std::to_string(options.count));
  keep("no-emergencies", options.no_emergencies ? "true" : "");
  if (!options.rack_file.empty()) {
    keep_rack(options.rack_file, configuration.named_files, header);
  } else if (!configuration.named_files.empty()) {
    throw Failure(fmt::format(
        "a recording keeps the files that a rack file names, and \"{}\" stands in a --set of a "
        "device without one; write a rack file with the device to record it",
        configuration.named_files.front()));
  }
  if (!configuration.state.empty()) {
    keep("state", "kept");
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(configuration.state, error)) {
      if (entry.is_regular_file() && !entry.path().filename().string().starts_with('.')) {
        header.files.emplace_back(std::string(kStateFolder) + entry.path().filename().string(),
                                  read_file(entry.path().string()));
      }
    }
  }
  return header;
}

RunOptions options_of(const RecordingHeader& header, const fs::path& folder,
                      const fs::path& state) {
  RunOptions options;
  for_each_option(
      options, [&header](const char* name, std::string& value) { value = header.option(name); },
      [&header](const char* name, std::vector<std::string>& values) {
        for (const auto& [key, value] : header.options) {
          if (key == name) {
            values.push_back(value);
          }
        }
      });
  const std::string_view count = header.option("count");
  std::from_chars(count.data(), count.data() + count.size(), options.count);
  options.no_emergencies = !header.option("no-emergencies").empty();
  if (const std::string_view rack = header.option("rack"); !rack.empty()) {
    options.rack_file = (folder / kRackFolder / rack).string();
  }
  for (const auto& [name, content] : header.files) {
    if (name.starts_with(kStateFolder)) {
      if (!state.empty()) {
        write_below(state, name.substr(kStateFolder.size()), content);
      }
    } else {
      write_below(folder, name, content);
    }
  }
  if (!header.option("state").empty()) {
    options.state = state.string();
    std::error_code error;
    fs::create_directories(state, error);
  }
  return options;
}

}  // namespace stator::cli
