#include "stator/rack/file/rack_check.hpp"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/file/rack_file_steps.hpp"
#include "stator/rack/file/shared_addresses.hpp"
#include "stator/rack/file/system_files.hpp"
#include "stator/rack/kept/device_storage.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/observe/recorder.hpp"

namespace stator::rack {

namespace {

/// Hands the devices what the state directory keeps for them, one after the other.
void check_state(const RackConfiguration& configuration, TableReader& root,
                 settings::Problems& problems) {
  const auto collect = [&](const auto& attach) {
    try {
      attach();
    } catch (const std::runtime_error& error) {
      problems.list.emplace_back(error.what());
    }
  };
  std::error_code ignored;
  const std::filesystem::path directory(configuration.state);
  if (!std::filesystem::exists(directory, ignored)) {
    const std::filesystem::path parent = directory.parent_path();
    if (!parent.empty() && !std::filesystem::is_directory(parent, ignored)) {
      root.refuse("state", fmt::format("\"state\" is \"{}\", which cannot be created: {} is no "
                                       "directory; create it, or name another one",
                                       configuration.state, parent.string()));
    }
    return;
  }
  collect([&] {
    std::vector<std::unique_ptr<product::EtherCatDevice>> slaves;
    std::vector<std::unique_ptr<product::CanDevice>> nodes;
    DeviceStorage storage(configuration.state, StateDirectory::Use::look);
    for (const SegmentConfiguration& segment : configuration.segments) {
      for (const DeviceConfiguration& device : segment.devices) {
        slaves.push_back(make_ethercat_device(device.setup, {}));
        collect([&] { storage.attach(device.name, *slaves.back(), {}); });
      }
    }
    for (const BusConfiguration& bus : configuration.buses) {
      for (const DeviceConfiguration& device : bus.devices) {
        nodes.push_back(make_can_device(device.setup, {}));
        collect([&] {
          storage.attach(device.name, device.setup.product().identity().name(), *nodes.back(), {});
        });
      }
    }
  });
}

void check_signals(const RecordConfiguration& record, Rack& rack, TableReader& root) {
  auto section = root.section("record");
  for (const std::string& pattern : record.signals) {
    try {
      static_cast<void>(select_signals(rack.signals(), {pattern}));
    } catch (const std::runtime_error& error) {
      section->refuse("signals", error.what());
    }
  }
  if (record.signals.empty()) {
    section->refuse("signals", "no signal is chosen; name at least one, e.g. \"*\",");
  }
}

/// What shows only when the devices are there.
void check_devices(const RackConfiguration& configuration, TableReader& root,
                   settings::Problems& problems) {
  RackConfiguration still = configuration;
  still.state.clear();
  still.record.reset();
  for (BusConfiguration& bus : still.buses) {
    bus.log.clear();
    bus.capture.clear();
  }
  EventLog log;
  try {
    Rack rack(still, log);
    if (configuration.record) {
      check_signals(*configuration.record, rack, root);
    }
    if (!configuration.state.empty()) {
      check_state(configuration, root, problems);
    }
  } catch (const std::exception& error) {
    problems.list.emplace_back(fmt::format("{}: {}", root.file(), error.what()));
  }
}

void sort_by_place(std::vector<settings::Problem>& problems, const std::string& file) {
  std::ranges::stable_sort(problems, {}, [&file](const settings::Problem& error) {
    return std::tuple(error.file() != file, error.line() == 0, error.file(), error.line(),
                      error.column());
  });
}

}  // namespace

RackCheck check_rack_file(const std::string& path, const product::Catalogue& catalogue,
                          Changes changes) {
  try {
    return check_rack_text(read_rack_text(path), path, catalogue, changes);
  } catch (const RackFileError& error) {
    RackCheck check;
    check.errors.push_back(error.problem());
    return check;
  }
}

RackCheck check_rack_text(std::string_view text, const std::string& path,
                          const product::Catalogue& catalogue, Changes changes) {
  settings::Problems problems;
  problems.everything = true;
  RackCheck check;
  try {
    settings::Value tree = parse_rack_tree(text, path);
    apply_changes(changes, tree, problems);
    const settings::Reading reading{problems, &system_files(), path};
    TableReader root(reading, "the rack", tree);
    root.attempt([&] {
      RackConfiguration configuration = read_rack(root, catalogue);
      if (problems.list.empty()) {
        check_devices(configuration, root, problems);
      }
      check.warnings = shared_addresses(configuration);
      check.configuration = std::move(configuration);
    });
  } catch (const RackFileError& error) {
    problems.list.push_back(error.problem());
  }
  if (!problems.list.empty()) {
    check.configuration.reset();
  }
  check.errors = std::move(problems.list);
  sort_by_place(check.errors, path);
  return check;
}

}  // namespace stator::rack
