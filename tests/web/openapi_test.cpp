// That the OpenAPI document describes every route, and equals docs/openapi.json.
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "source_paths.hpp"
#include "stator/web/api/routes.hpp"

namespace stator::web {
namespace {

using nlohmann::json;

void collect_references(const json& value, std::set<std::string>& references) {
  if (value.is_object() && value.contains("$ref")) {
    references.insert(value["$ref"].get<std::string>());
  }
  for (const json& element : value) {
    if (element.is_structured()) {
      collect_references(element, references);
    }
  }
}

TEST(OpenApi, DescribesEveryRouteAndRefersToNothingMissing) {
  const json document = json::parse(openapi_document());
  EXPECT_EQ(document["openapi"], "3.1.0");
  std::set<std::string> ids;
  for (const Route& route : routes()) {
    std::string method(route.method);
    std::ranges::transform(method, method.begin(), [](unsigned char letter) {
      return static_cast<char>(std::tolower(letter));
    });
    const json& operation = document["paths"][std::string(route.path)][method];
    EXPECT_EQ(operation["operationId"], std::string(route.id));
    EXPECT_TRUE(ids.insert(std::string(route.id)).second) << route.id;
    EXPECT_EQ(operation.contains("requestBody"), !route.request_schema.empty()) << route.path;
    std::size_t braces = 0;
    for (const json& parameter : operation.value("parameters", json::array())) {
      braces += parameter["in"] == "path" ? 1U : 0U;
    }
    EXPECT_EQ(braces, static_cast<std::size_t>(std::ranges::count(route.path, '{')));
  }
  std::set<std::string> references;
  collect_references(document, references);
  EXPECT_GT(references.size(), 10U);
  for (const std::string& reference : references) {
    EXPECT_TRUE(document.contains(json::json_pointer(reference.substr(1)))) << reference;
  }
}

// STATOR_WRITE_OPENAPI=1 test_web --gtest_filter='OpenApi.*' renews the file.
TEST(OpenApi, IsTheFileInTheDocumentation) {
  const std::string path = STATOR_SOURCE_DIR "/docs/openapi.json";
  if (std::getenv("STATOR_WRITE_OPENAPI") != nullptr) {  // NOLINT(concurrency-mt-unsafe)
    std::ofstream(path) << openapi_document();
  }
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), openapi_document());
}

}  // namespace
}  // namespace stator::web
