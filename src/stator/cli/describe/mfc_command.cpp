// stator mfc: checks a configuration of the TMC8461's I/O block, writes it as SII image and ESI
// file, and reads it from an image.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/describe/mfc_listing.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/files.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/formats/esi/chip_esi.hpp"
#include "stator/product/catalogue/io_configuration.hpp"
#include "stator/rack/file/rack_file_steps.hpp"

namespace stator::cli {

namespace {

struct ConfigOptions {
  std::string file;
  std::string sii;
  std::string esi;
  std::string from_sii;
  std::string output;
  std::string format = "table";
};

/// Of the first product with an I/O block. Throws Failure if there is none.
std::unique_ptr<product::IoConfiguration> new_configuration() {
  for (const auto& product : catalogue().products()) {
    if (auto configuration = product->io_configuration()) {
      return configuration;
    }
  }
  throw Failure("no product has a multi-function I/O block");
}

/// What an EEPROM with this image makes of the block. Throws Failure if it is none of one.
std::string decode(const std::string& path) {
  const std::string bytes = read_file(path);
  const auto contents = ethercat::parse_sii_image(std::as_bytes(std::span(bytes)));
  if (!contents) {
    throw Failure(path + ": no SII image: truncated, or its checksum is wrong");
  }
  if (contents->parameter_ram.empty()) {
    throw Failure(path + ": has no category 1, which holds the configuration of the I/O block");
  }
  const auto configuration = new_configuration();
  configuration->take(*contents);
  return configuration->text();
}

void configure(const ConfigOptions& options) {
  if (!options.from_sii.empty()) {
    write_output(options.output, decode(options.from_sii), false, "a configuration");
    return;
  }
  if (options.file.empty()) {
    throw Failure("name a configuration file, or an SII image with --from-sii");
  }
  const auto configuration = new_configuration();
  rack::read_tree(
      rack::parse_rack_tree(rack::read_rack_text(options.file, "configuration"), options.file),
      options.file, "the configuration",
      [&](settings::Reader& root) { configuration->read(root); });
  const auto contents = configuration->sii_contents();
  const auto image = ethercat::compose_sii_image(contents);
  if (!options.sii.empty()) {
    write_file(options.sii,
               std::string_view(reinterpret_cast<const char*>(image.data()), image.size()));
  }
  if (!options.esi.empty()) {
    write_file(options.esi, formats::chip_esi_xml(contents, configuration->vendor_name(), image));
  }
  print_mfc_map(configuration->block(), options.format);
}

}  // namespace

void add_mfc_command(CLI::App& app) {
  auto options = std::make_shared<ConfigOptions>();
  CLI::App* group = app.add_subcommand("mfc", "The multi-function I/O block of the TMC8461");
  group->require_subcommand(1);
  CLI::App* command = group->add_subcommand(
      "config", "Check a configuration, print its memory map, make SII image and ESI file");
  command->add_option("file", options->file, "Configuration, see docs/how-to/mfc-configuration.md")
      ->check(names(Names::rack_file));
  command->add_option("--sii", options->sii, "SII image to write")->check(names(Names::file));
  command->add_option("--esi", options->esi, "ESI file to write")->check(names(Names::file));
  command->add_option("--format", options->format, "Of the memory map: table, csv or json")
      ->check(one_of({"table", "csv", "json"}))
      ->capture_default_str();
  CLI::Option* from = command
                          ->add_option("--from-sii", options->from_sii,
                                       "Print the configuration that an SII image holds")
                          ->check(names(Names::file));
  command->add_option("-o,--output", options->output, "With --from-sii: file to write")
      ->check(names(Names::file))
      ->needs(from);
  command->footer(
      "Examples:\n"
      "  stator mfc config examples/mfc/motion.toml --sii motion.bin --esi motion.xml\n"
      "  stator mfc config --from-sii motion.bin");
  command->callback([options] { configure(*options); });
}

}  // namespace stator::cli
