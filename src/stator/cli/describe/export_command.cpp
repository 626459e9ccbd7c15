// stator export: writes files of a product, such as ESI, SII or EDS, or the content of a file that
// a device keeps.
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/files.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/formats/esi/esi.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/kept/kept_file.hpp"
#include "stator/rack/kept/state_directory.hpp"

namespace stator::cli {

namespace {

struct ExportOptions {
  std::string kind;
  std::string device;
  std::string output;
};

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// What a file of a state directory keeps, also while a rack uses it. Throws std::runtime_error.
std::string content_of(const std::string& path) {
  const std::filesystem::path file(path);
  const std::string directory = file.has_parent_path() ? file.parent_path().string() : ".";
  const auto bytes = rack::StateDirectory(directory, rack::StateDirectory::Use::look)
                         .read(file.filename().string());
  if (!bytes) {
    throw Failure(fmt::format("{}: there is no such file", path));
  }
  try {
    return text_of(rack::decode(*bytes).content);
  } catch (const std::runtime_error& error) {
    throw Failure(fmt::format("{}: {}", path, error.what()));
  }
}

/// The file as a string of bytes. Throws std::runtime_error if the product has no such file.
std::string file_of(const ExportOptions& options) {
  if (options.kind == "content") {
    return content_of(options.device);
  }
  const product::Setup setup = find_product(options.device)->defaults();
  if (options.kind == "eds") {
    return std::string(rack::make_can_device(setup, {})->eds());
  }
  const auto device = rack::make_ethercat_device(setup, {});
  const auto sii = device->sii_image();
  return options.kind == "sii" ? text_of(sii)
                               : formats::esi_xml(device->description(), device->dictionary(), sii);
}

void export_file(const ExportOptions& options) {
  const bool kept = options.kind == "content";
  write_output(options.output, file_of(options), kept || options.kind == "sii",
               kept ? "the content of a kept file" : "an SII image");
}

}  // namespace

void add_export_command(CLI::App& app) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command =
      app.add_subcommand("export",
                         "Write the SII image, ESI file or EDS file of a product, or the "
                         "content of a kept file");
  command
      ->add_option("kind", options->kind,
                   "sii (EEPROM image), esi (XML for EtherCAT masters), eds (for CANopen masters) "
                   "or content "
                   "(of a file in a state directory)")
      ->required()
      ->check(one_of({"sii", "esi", "eds", "content"}));
  command
      ->add_option("device", options->device,
                   "Product, see \"stator devices\"; for content: the file")
      ->required()
      ->check(names(Names::product));
  command->add_option("-o,--output", options->output, "File to write; standard output if left out")
      ->check(names(Names::file));
  command->footer(
      "Examples:\n"
      "  stator export esi tmcm-3315 -o tmcm-3315.xml\n"
      "  stator export eds tmcc160 -o tmcc160.eds\n"
      "  stator export content kept/tmcm-3315.eeprom -o image.bin");
  command->callback([options] { export_file(*options); });
}

}  // namespace stator::cli
