#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "stator/scenario/report.hpp"

namespace stator::scenario {

namespace {

/// XML 1.0 has no way to write most control characters.
std::string printable(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t'; },
      '?');
  return text;
}

void set(pugi::xml_node node, const char* name, const std::string& value) {
  node.append_attribute(name).set_value(printable(value).c_str());
}

void append_text(pugi::xml_node node, const char* name, const std::string& message,
                 const std::string& text) {
  pugi::xml_node child = node.append_child(name);
  set(child, "message", message);
  child.append_child(pugi::node_pcdata).set_value(printable(text).c_str());
}

std::string failure_text(const ScenarioResult& result, const StepResult& step) {
  std::string text = fmt::format("{}:{}: {}\n{}\n", result.file, step.line, step.title, step.text);
  for (const std::string& line : result.events) {
    text += line + "\n";
  }
  return text;
}

void append_case(pugi::xml_node suite, const ScenarioResult& result, const StepResult& step,
                 std::size_t number) {
  pugi::xml_node node = suite.append_child("testcase");
  set(node, "classname", result.name);
  set(node, "name", fmt::format("{} {}: {}", number, step.kind, step.title));
  set(node, "time", fmt::format("{:.6f}", (step.end - step.begin).seconds()));
  set(node, "file", result.file);
  set(node, "line", std::to_string(step.line));
  if (step.status == Status::failed) {
    append_text(node, "failure", step.text, failure_text(result, step));
  } else if (step.status == Status::not_run) {
    node.append_child("skipped").append_attribute("message") = "a step before it has failed";
  }
}

std::size_t count(const ScenarioResult& result, Status status) {
  return static_cast<std::size_t>(std::ranges::count(result.steps, status, &StepResult::status));
}

void append_suite(pugi::xml_node root, const ScenarioResult& result) {
  const bool unrun = result.status == Status::error;
  pugi::xml_node suite = root.append_child("testsuite");
  set(suite, "name", result.name);
  set(suite, "file", result.file);
  set(suite, "tests", std::to_string(unrun ? 1 : result.steps.size()));
  set(suite, "failures", std::to_string(count(result, Status::failed)));
  set(suite, "errors", unrun ? "1" : "0");
  set(suite, "skipped", std::to_string(unrun ? 0 : count(result, Status::not_run)));
  set(suite, "time", fmt::format("{:.3f}", result.wall_seconds));
  pugi::xml_node property = suite.append_child("properties").append_child("property");
  set(property, "name", "simulated_seconds");
  set(property, "value", fmt::format("{:.9f}", result.end.seconds()));
  if (unrun) {
    pugi::xml_node node = suite.append_child("testcase");
    set(node, "classname", result.name);
    set(node, "name", "reading the scenario");
    set(node, "time", "0");
    append_text(node, "error", result.error, result.error);
    return;
  }
  for (std::size_t i = 0; i < result.steps.size(); ++i) {
    append_case(suite, result, result.steps[i], i + 1);
  }
}

}  // namespace

std::string junit_report(std::span<const ScenarioResult> results) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node root = document.append_child("testsuites");
  double seconds = 0.0;
  for (const ScenarioResult& result : results) {
    append_suite(root, result);
    seconds += result.wall_seconds;
  }
  root.append_attribute("name") = "stator test";
  set(root, "time", fmt::format("{:.3f}", seconds));
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

}  // namespace stator::scenario
