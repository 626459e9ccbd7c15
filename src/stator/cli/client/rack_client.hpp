#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "stator/cli/client/http_client.hpp"

namespace CLI {
class App;
}

namespace stator::cli {

/// How to reach the web server of a running rack.
struct RackClientOptions {
  std::string url = "http://127.0.0.1:8080";
  std::string token_file;  ///< empty: the environment's STATOR_TOKEN, if any
};

/// Adds --http and --http-token to a command.
void add_client_options(CLI::App& command, RackClientOptions& options);

/// Talks to a rack that `stator run --http` serves. All throw Failure when nobody answers there,
/// and with the server's own reason when it refuses.
class RackClient {
 public:
  explicit RackClient(const RackClientOptions& options);

  [[nodiscard]] nlohmann::json get(const std::string& target);
  /// The same; null if the server has nothing at that path.
  [[nodiscard]] nlohmann::json get_if_there(const std::string& target);
  nlohmann::json post(const std::string& target, const nlohmann::json& body);
  nlohmann::json put(const std::string& target);
  nlohmann::json remove(const std::string& target);

 private:
  [[nodiscard]] nlohmann::json request(const std::string& method, const std::string& target,
                                       const std::string& body);

  HttpClient client_;
};

}  // namespace stator::cli
