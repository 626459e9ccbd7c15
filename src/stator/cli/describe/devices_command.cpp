// stator devices: lists the types of products, what each is and over which network it is reached.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/commands.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/product/catalogue/product.hpp"

namespace stator::cli {

namespace {

void print_products_as_json() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& product : catalogue().products()) {
    const product::Identity& identity = product->identity();
    list.push_back({{"type", identity.type},
                    {"name", identity.name()},
                    {"summary", identity.summary},
                    {"reached_over", identity.reached_over}});
  }
  fmt::print("{}\n", list.dump(2));
}

}  // namespace

void add_devices_command(CLI::App& app) {
  auto format = std::make_shared<std::string>("text");
  CLI::App* command = app.add_subcommand("devices", "List the products that can be run");
  command->add_option("--format", *format, "text or json")
      ->check(one_of({"text", "json"}))
      ->capture_default_str();
  command->callback([format] {
    if (*format == "json") {
      print_products_as_json();
      return;
    }
    fmt::print("{:12}  {:58}  {}\n", "DEVICE", "WHAT IT IS", "REACHED OVER");
    for (const auto& product : catalogue().products()) {
      const product::Identity& identity = product->identity();
      fmt::print("{:12}  {:58}  {}\n", identity.type, identity.summary, identity.reached_over);
    }
  });
}

}  // namespace stator::cli
