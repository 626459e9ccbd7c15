#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "cli/commands.hpp"
#include "cli/files.hpp"
#include "rack/esi.hpp"
#include "rack/product_catalogue.hpp"

namespace stator::cli {

namespace {

struct ExportOptions {
  std::string kind;
  std::string device;
  std::string output;
};

/// The file as a string of bytes. Throws std::runtime_error if the product has no such file.
std::string file_of(const ExportOptions& options) {
  const rack::ProductConfiguration product =
      rack::require_product(options.device).default_configuration();
  if (options.kind == "eds") {
    return std::string(rack::make_can_device(product, {})->eds());
  }
  const auto device = rack::make_ethercat_device(product, {});
  const auto sii = device->sii_image();
  return options.kind == "sii" ? std::string(reinterpret_cast<const char*>(sii.data()), sii.size())
                               : rack::esi_xml(device->description(), device->dictionary(), sii);
}

void export_file(const ExportOptions& options) {
  write_output(options.output, file_of(options), options.kind == "sii", "an SII image");
}

}  // namespace

void add_export_command(CLI::App& app) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command =
      app.add_subcommand("export", "Write the SII image, ESI file or EDS file of a product");
  command
      ->add_option(
          "kind", options->kind,
          "sii (EEPROM image), esi (XML for EtherCAT masters) or eds (for CANopen masters)")
      ->required()
      ->check(CLI::IsMember({"sii", "esi", "eds"}));
  command->add_option("device", options->device, "Product, see \"stator devices\"")->required();
  command->add_option("-o,--output", options->output, "File to write; standard output if left out");
  command->footer(
      "Examples:\n"
      "  stator export esi tmcm-3315 -o tmcm-3315.xml\n"
      "  stator export eds tmcc160 -o tmcc160.eds");
  command->callback([options] { export_file(*options); });
}

}  // namespace stator::cli
