// That clients of the web server change no bit of a run in lockstep.
#include <atomic>
#include <cstdio>
#include <fstream>
#include <optional>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "rack/text_log.hpp"
#include "stator/bench/link_port.hpp"
#include "stator/link/ethernet/open_link.hpp"
#include "stator/master/master.hpp"
#include "web/served_rack.hpp"

namespace stator::web {
namespace {

std::string content(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The same frames each time.
void talk(const link::LinkAddress& address) {
  const auto opened = link::open_link(address, link::LinkEnd::master, {});
  ASSERT_TRUE(opened) << opened.error().text;
  bench::LinkPort port(**opened);
  for (int i = 0; i < 10; ++i) {
    master::Master master(port);
    ASSERT_TRUE(master.scan());
  }
}

/// Reads all there is and streams signals until told to stop.
void watch(std::uint16_t port, const std::atomic<bool>& stopping, std::atomic<int>& rounds) {
  HttpClient stream(port);
  EXPECT_EQ(stream.request("GET", "/api/v1/signals", {}, HttpClient::upgrade_fields()).status, 101);
  stream.send_frame(1, R"({"signals": ["drive.axis0.*"], "period": "150us"})");
  HttpClient traffic(port);
  EXPECT_EQ(traffic.request("GET", "/api/v1/traffic", {}, HttpClient::upgrade_fields()).status,
            101);
  traffic.send_frame(1, R"({"networks": []})");
  HttpClient client(port);
  while (!stopping) {
    for (const char* device : {"drive", "servo"}) {
      const std::string objects = std::string("/api/v1/devices/") + device + "/objects";
      std::string last;
      const auto declared = client.request("GET", objects).json();
      for (const auto& entry : declared["entries"]) {
        const auto index = entry["index"].get<std::string>();
        if (index != last && !stopping) {
          EXPECT_EQ(client.request("GET", objects + "/" + index).status, 200);
          ++rounds;
        }
        last = index;
      }
      if (stopping) {
        return;
      }
    }
    for (const char* target : {"/metrics", "/api/v1/wiring", "/api/v1/devices/drive/panel",
                               "/api/v1/devices/servo/panel"}) {
      EXPECT_EQ(client.request("GET", target).status, 200);
    }
  }
}

TEST(WebDeterminism, WatchingChangesNothingOfALockstepRun) {
  const std::string alone = ::testing::TempDir() + "stator-web-alone.csv";
  const std::string watched = ::testing::TempDir() + "stator-web-watched.csv";
  {
    const rack::RackConfiguration configuration =
        ServedRack::configuration(rack::ClockKind::lockstep, alone);
    rack::EventLog log;
    rack::Rack rack(configuration, log);
    rack::Runner runner(rack, configuration, tests::no_log());
    runner.start();
    talk(configuration.segments[0].link);
    runner.stop();
  }
  std::atomic<int> rounds{0};
  {
    ServedRack rack({}, rack::ClockKind::lockstep, "127.0.0.1", watched);
    std::atomic<bool> stopping{false};
    std::thread watcher([&] { watch(rack.port(), stopping, rounds); });
    while (rounds < 20) {
      std::this_thread::yield();
    }
    talk(rack.configuration().segments[0].link);
    stopping = true;
    watcher.join();
  }
  EXPECT_GT(rounds, 20);
  const std::string expected = content(alone);
  EXPECT_GT(std::ranges::count(expected, '\n'), 100) << "little time has passed";
  EXPECT_TRUE(expected == content(watched)) << alone << " and " << watched << " differ";
  std::remove(alone.c_str());
  std::remove(watched.c_str());
}

}  // namespace
}  // namespace stator::web
