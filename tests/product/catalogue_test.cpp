// Catalogues of products, also with products of a program's own, and devices configured from them.
#include "stator/product/catalogue/catalogue.hpp"

#include <memory>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace stator::product {
namespace {

class Lamp final : public Device {
 public:
  Lamp(double watts, base::EventReporter /*reporter*/) : watts_(watts) {}

  void advance(base::SimTime /*now*/) override {}
  void handle_bus_events(base::SimTime /*now*/) override {}
  void set_power(bool /*on*/, base::SimTime /*now*/) override {}
  [[nodiscard]] std::vector<Signal> signals() const override { return {}; }
  [[nodiscard]] double watts() const { return watts_; }

 private:
  double watts_;
};

struct LampConfiguration {
  double watts = 5.0;
  CoeOptions coe;
};

class LampProduct final : public Product {
 public:
  explicit LampProduct(std::string type)
      : identity_{.type = std::move(type), .summary = "a lamp", .reached_over = "EtherCAT"} {}

  [[nodiscard]] const Identity& identity() const override { return identity_; }
  [[nodiscard]] Setup defaults() const override {
    return {shared_from_this(), LampConfiguration{}};
  }
  [[nodiscard]] std::unique_ptr<Device> make(const Setup& setup,
                                             base::EventReporter reporter) const override {
    return std::make_unique<Lamp>(setup.as<LampConfiguration>().watts, reporter);
  }
  [[nodiscard]] const CoeOptions* coe(const Setup& setup) const override {
    return &setup.as<LampConfiguration>().coe;
  }

 private:
  Identity identity_;
};

TEST(Catalogue, FindsProductsByTypeInTheOrderInWhichTheyCame) {
  Catalogue catalogue;
  catalogue.add(std::make_shared<LampProduct>("lamp"));
  catalogue.add(std::make_shared<LampProduct>("big-lamp"));
  ASSERT_EQ(catalogue.products().size(), 2U);
  EXPECT_EQ(catalogue.products()[0]->identity().type, "lamp");
  EXPECT_EQ(catalogue.find("big-lamp")->identity().name(), "BIG-LAMP");
  EXPECT_EQ(catalogue.find("small-lamp"), nullptr);
  EXPECT_THROW(catalogue.add(std::make_shared<LampProduct>("lamp")), std::logic_error);
}

TEST(Setup, IsCopiedWithItsConfigurationAndOutlivesTheCatalogue) {
  product::Setup setup;
  {
    Catalogue catalogue;
    catalogue.add(std::make_shared<LampProduct>("lamp"));
    setup = catalogue.find("lamp")->defaults();
  }
  product::Setup other = setup;
  other.as<LampConfiguration>().watts = 60.0;
  other.coe()->emergencies = false;
  EXPECT_EQ(dynamic_cast<Lamp&>(*setup.make()).watts(), 5.0);
  EXPECT_EQ(dynamic_cast<Lamp&>(*other.make()).watts(), 60.0);
  EXPECT_TRUE(setup.coe()->emergencies);
  EXPECT_FALSE(other.as<LampConfiguration>().coe.emergencies);
  EXPECT_EQ(setup.node_id(), nullptr);
  EXPECT_TRUE(setup.axes().empty());
}

TEST(Setup, OfAnotherProductIsToldApart) {
  const product::Setup setup = std::make_shared<LampProduct>("lamp")->defaults();
  EXPECT_EQ(setup.find<CoeOptions>(), nullptr);
  EXPECT_THROW(static_cast<void>(setup.as<CoeOptions>()), std::logic_error);
}

TEST(Product, OfAProgramsOwnNeedsAnIdentityAndAMakerOnly) {
  const auto own = make_product(
      {.type = "own", .summary = "a lamp", .reached_over = "CAN", .network = NetworkKind::bus},
      [](base::EventReporter reporter) { return std::make_unique<Lamp>(7.0, reporter); });
  EXPECT_EQ(dynamic_cast<Lamp&>(*own->defaults().make()).watts(), 7.0);
}

}  // namespace
}  // namespace stator::product
