#include "web/http_client.hpp"

#include <array>
#include <cstddef>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "web/contract.hpp"

namespace stator::web {

HttpClient::HttpClient(std::uint16_t port, int receive_buffer) : port_(port) {
  socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval limit{120, 0};  // for busy machines with sanitizers
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
  if (receive_buffer != 0) {
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
}

HttpClient::~HttpClient() {
  ::close(socket_);
}

bool HttpClient::send(std::string_view bytes) {
  const std::size_t space = bytes.find(' ');
  const std::size_t end = bytes.find(" HTTP/1.1\r\n");
  if (end != std::string_view::npos && space < end && bytes.find('\n') > end) {
    method_ = bytes.substr(0, space);
    target_ = bytes.substr(space + 1, end - space - 1);
  }
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) {
      return false;
    }
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

bool HttpClient::fill() {
  std::array<char, 65536> bytes{};
  const ssize_t received = ::recv(socket_, bytes.data(), bytes.size(), 0);
  if (received <= 0) {
    return false;
  }
  buffer_.append(bytes.data(), static_cast<std::size_t>(received));
  return true;
}

Answer HttpClient::receive(bool head) {
  const Answer answer = read_answer(head);
  if (answer.status != 0) {
    const std::string violation = Contract::own().violation(method_, target_, answer);
    EXPECT_EQ(violation, "") << method_ << " " << target_;
  }
  return answer;
}

Answer HttpClient::read_answer(bool head) {
  Answer answer;
  std::size_t end = 0;
  while ((end = buffer_.find("\r\n\r\n")) == std::string::npos) {
    if (!fill()) {
      return answer;
    }
  }
  std::string lines = buffer_.substr(0, end + 2);
  buffer_.erase(0, end + 4);
  answer.status = std::stoi(lines.substr(9, 3));
  for (std::size_t at = lines.find("\r\n") + 2; at < lines.size();) {
    const std::size_t line_end = lines.find("\r\n", at);
    const std::size_t colon = lines.find(':', at);
    std::string name = lines.substr(at, colon - at);
    for (char& letter : name) {
      letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    }
    answer.headers[name] = lines.substr(colon + 2, line_end - colon - 2);
    at = line_end + 2;
  }
  const auto length = answer.headers.find("content-length");
  if (head || length == answer.headers.end()) {
    return answer;
  }
  const std::size_t size = std::stoul(length->second);
  while (buffer_.size() < size && fill()) {
  }
  answer.body = buffer_.substr(0, size);
  buffer_.erase(0, size);
  return answer;
}

Answer HttpClient::request(const std::string& method, const std::string& target,
                           const std::string& body, const std::string& fields) {
  std::string text =
      fmt::format("{} {} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{}", method, target, port_, fields);
  if (!body.empty()) {
    text += fmt::format("Content-Type: application/json\r\nContent-Length: {}\r\n", body.size());
  }
  send(text + "\r\n" + body);
  return receive(method == "HEAD");
}

bool HttpClient::ended() {
  std::array<char, 4096> bytes{};
  ssize_t received = 0;
  while ((received = ::recv(socket_, bytes.data(), bytes.size(), 0)) > 0) {
  }
  return received == 0 || errno == ECONNRESET;
}

std::string HttpClient::upgrade_fields() {
  return "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
}

bool HttpClient::send_frame(unsigned opcode, std::string_view payload, bool masked) {
  std::string frame;
  frame += static_cast<char>(0x80U | opcode);
  const unsigned mask_bit = masked ? 0x80U : 0U;
  if (payload.size() < 126) {
    frame += static_cast<char>(mask_bit | payload.size());
  } else {
    frame += static_cast<char>(mask_bit | 126U);
    frame += static_cast<char>(payload.size() >> 8U);
    frame += static_cast<char>(payload.size() & 0xFFU);
  }
  if (masked) {
    frame += std::string(4, '\0');  // a mask of zeros
  }
  return send(frame + std::string(payload));
}

std::optional<HttpClient::Frame> HttpClient::receive_frame() {
  const auto need = [this](std::size_t bytes) {
    while (buffer_.size() < bytes) {
      if (!fill()) {
        return false;
      }
    }
    return true;
  };
  const auto byte = [this](std::size_t at) {
    return static_cast<std::size_t>(static_cast<unsigned char>(buffer_[at]));
  };
  if (!need(2)) {
    return std::nullopt;
  }
  std::size_t length = byte(1);
  std::size_t start = 2;
  const std::size_t extra = length == 126 ? 2 : length == 127 ? 8 : 0;
  if (extra != 0) {
    if (!need(start + extra)) {
      return std::nullopt;
    }
    length = 0;
    for (std::size_t i = 0; i < extra; ++i) {
      length = length << 8U | byte(start + i);
    }
    start += extra;
  }
  if (!need(start + length)) {
    return std::nullopt;
  }
  Frame frame{static_cast<unsigned>(byte(0) & 0x0FU), buffer_.substr(start, length)};
  buffer_.erase(0, start + length);
  if (frame.opcode == 1 || frame.opcode == 2) {
    EXPECT_EQ(Contract::own().violation(target_, frame.opcode == 2, frame.payload), "") << target_;
  }
  return frame;
}

nlohmann::json HttpClient::receive_message(const std::string& type) {
  while (const auto frame = receive_frame()) {
    if (frame->opcode == 1) {
      nlohmann::json message = nlohmann::json::parse(frame->payload, nullptr, false);
      if (message.value("type", "") == type) {
        return message;
      }
    }
  }
  return nullptr;
}

}  // namespace stator::web
