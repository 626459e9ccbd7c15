#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace stator::web {

struct Answer;

/// What a server describes of itself, its OpenAPI document, against which all is held that it says.
/// More than the document demands of others: a member that it does not describe is wrong, too.
class Contract {
 public:
  /// Throws if the document is none.
  explicit Contract(const std::string& document);
  ~Contract();
  Contract(const Contract&) = delete;
  Contract& operator=(const Contract&) = delete;

  /// That of the server that is tested.
  static const Contract& own();

  /// What is wrong with an answer to `method` at `target`, which are empty if no request could be
  /// read from what was sent; empty: nothing.
  [[nodiscard]] std::string violation(std::string_view method, std::string_view target,
                                      const Answer& answer) const;
  /// The same of a message of the WebSocket that was opened at `target`.
  [[nodiscard]] std::string violation(std::string_view target, bool binary,
                                      const std::string& message) const;

 private:
  struct Schemas;

  /// Null: nothing is described there.
  [[nodiscard]] const nlohmann::json* operation(std::string_view method,
                                                std::string_view target) const;
  [[nodiscard]] std::string violation(const nlohmann::json& schema,
                                      const nlohmann::json& value) const;

  nlohmann::json document_;
  mutable std::mutex mutex_;  ///< of the schemas, which are parsed when they are first needed
  std::unique_ptr<Schemas> schemas_;
};

}  // namespace stator::web
