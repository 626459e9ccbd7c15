// What a person does to a rack that runs: inject, status, clear, snapshot.

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "base/child_process.hpp"
#include "cli/stator_program.hpp"
#include "stator/cli/client/http_client.hpp"
#include "stator/cli/client/rack_overview.hpp"
#include "stator/cli/failure.hpp"

namespace stator::cli {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// `stator run` of a drive at a CAN bus with a web server, and the commands that go to it.
class RunningRack : public ::testing::Test {
 protected:
  /// `options`: further ones of `stator run`.
  void start(const std::string& options) {
    const std::string rack = tests::temporary("running.toml");
    log_ = tests::temporary("running.log");
    std::ofstream(rack) << "[[bus]]\nbit_rate = 1000\nports = [\"slcan:" +
                               tests::temporary("running.can") +
                               "\"]\n[[bus.device]]\ntype = \"tmcc160\"\nname = \"spindle\"\n"
                               "node_id = 5\n";
    std::string command = "exec ";
    command += STATOR_PROGRAM;
    command += " run " + rack + " --http 127.0.0.1:0 " + options + " >" + log_ + " 2>&1 </dev/null";
    process_ = tests::ChildProcess::run({"/bin/sh", "-c", command});
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    std::string text;
    do {
      ASSERT_LT(std::chrono::steady_clock::now(), end) << text;
      ASSERT_TRUE(process_.runs()) << tests::content(log_);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      text = tests::content(log_);
    } while (text.find("Running;") == std::string::npos);
    address_ = between(text, "dashboard: http://", "/#token=");
    const std::string token = between(text, "/#token=", "\n");
    ::setenv("STATOR_TOKEN", token.c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  }

  void TearDown() override {
    ::unsetenv("STATOR_TOKEN");  // NOLINT(concurrency-mt-unsafe)
    if (process_.runs()) {
      process_.signal(SIGINT);
      EXPECT_EQ(process_.wait(), 0) << tests::content(log_);
    }
  }

  [[nodiscard]] const std::string& address() const { return address_; }

  [[nodiscard]] HttpClient client() const {
    return {parse_http_address(address_),
            std::getenv("STATOR_TOKEN")};  // NOLINT(concurrency-mt-unsafe)
  }
  /// The answer of its server, to a text if one is given.
  nlohmann::json ask(const std::string& method, const std::string& target,
                     const std::string& text = {}) {
    return client().json(method, target,
                         text.empty() ? std::string() : nlohmann::json{{"text", text}}.dump());
  }
  [[nodiscard]] bool recorded() { return ask("GET", "/api/v1/recording")["running"].get<bool>(); }
  /// Has it recorded into NAME.stator and waits until it is.
  void record(const std::string& name) {
    const std::string run = ask("GET", "/api/v1/rack")["run"];
    const HttpResponse answer =
        client().request("POST", "/api/v1/recording", nlohmann::json{{"name", name}}.dump());
    ASSERT_EQ(answer.status, 200) << answer.body;
    await_run_after(run);
    ASSERT_TRUE(recorded()) << log();
  }
  /// Waits until another run than `run` answers.
  void await_run_after(const std::string& run) {
    while (process_.runs()) {
      try {
        if (ask("GET", "/api/v1/rack")["run"] != run) {
          return;
        }
      } catch (const std::runtime_error&) {
        // One has gone and the next is not there yet.
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    FAIL() << log();
  }

  tests::Outcome command(const std::string& words) {
    return tests::stator(words + " --http " + address_);
  }
  /// Its exit status.
  int end() {
    process_.signal(SIGINT);
    return process_.wait();
  }
  [[nodiscard]] std::string log() const { return tests::content(log_); }

 private:
  static std::string between(const std::string& text, const std::string& first,
                             const std::string& next) {
    const std::size_t begin = text.find(first) + first.size();
    return text.substr(begin, text.find(next, begin) - begin);
  }

  tests::ChildProcess process_;
  std::string address_;
  std::string log_;
};

TEST_F(RunningRack, GetsFaultsAndLosesThemByCommand) {
  ASSERT_NO_FATAL_FAILURE(start(""));
  const tests::Outcome injected = command("inject can-drop --device spindle count=3");
  EXPECT_EQ(injected.status, 0) << injected.output;
  EXPECT_EQ(injected.output, "fault 1\n");
  const tests::Outcome status = command("status");
  EXPECT_EQ(status.status, 0) << status.output;
  EXPECT_THAT(status.output, AnyOf(HasSubstr(" initialisation\n"), HasSubstr(" pre-operational\n")))
      << "it has just been switched on";
  EXPECT_THAT(status.output, HasSubstr("can-drop"));
  EXPECT_EQ(command("clear 1").output, "fault 1 cleared\n");
  EXPECT_THAT(command("status").output, Not(HasSubstr("active")));
  const tests::Outcome unknown = command("clear 7");
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.output, HasSubstr("there is no fault 7"));
  const tests::Outcome refused = command("inject can-drop --device spindel count=3");
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.output, HasSubstr("spindle")) << "says which devices there are";
}

TEST_F(RunningRack, KeepsMomentsAndGoesBackToThem) {
  ASSERT_NO_FATAL_FAILURE(start("--record " + tests::temporary("running.stator")));
  EXPECT_EQ(command("snapshot list").output, "no snapshots\n");
  const tests::Outcome taken = command("snapshot take before");
  EXPECT_EQ(taken.status, 0) << taken.output;
  EXPECT_THAT(taken.output, HasSubstr("snapshot before taken at "));
  EXPECT_THAT(command("snapshot list").output, HasSubstr("  before\n"));
  EXPECT_THAT(command("snapshot list --format json").output, HasSubstr("\"name\": \"before\""));
  EXPECT_THAT(command("snapshot take before").output,
              HasSubstr("there is a snapshot of this name"));
  const tests::Outcome none = command("snapshot restore after");
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.output, HasSubstr("there is no such snapshot"));
  const tests::Outcome restored = command("snapshot restore before");
  EXPECT_THAT(restored.output, HasSubstr("snapshot before restored; from there on "));
  EXPECT_THAT(restored.output, HasSubstr("running-2.stator"));
  EXPECT_THAT(command("snapshot list").output, HasSubstr("  before\n"))
      << "it is back at its address";
  const tests::Outcome wrong = command("snapshot take \"5 s\"");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.output, HasSubstr("cannot be the name of a snapshot"));
}

TEST_F(RunningRack, IsSeenAnewOnceItWentBack) {
  ASSERT_NO_FATAL_FAILURE(start("--record " + tests::temporary("seen.stator")));
  ASSERT_EQ(command("snapshot take before").status, 0);
  HttpClient client(parse_http_address(address()), {});
  RackObserver observer(client);
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(command("inject can-drop --device spindle count=3").status, 0);
  }
  static_cast<void>(observer.look());
  const RackOverview before = observer.look();
  const std::size_t events = before.events.size();
  const std::string run = before.run;
  std::set<std::uint64_t> numbers;
  for (const RackOverview::Event& event : before.events) {
    EXPECT_TRUE(numbers.insert(event.number).second) << "each event comes once: " << event.text;
  }
  ASSERT_EQ(command("snapshot restore before").status, 0);
  const RackOverview& after = observer.look();
  EXPECT_NE(after.run, run);
  EXPECT_LT(after.events.size(), events) << "those of the run before are gone";
  const std::size_t kept = after.events.size();
  ASSERT_EQ(command("inject can-drop --device spindle count=3").status, 0);
  EXPECT_GT(observer.look().events.size(), kept) << "though its numbers were seen before";
}

TEST_F(RunningRack, GivesWayToAnotherRackAtTheSameAddress) {
  ASSERT_NO_FATAL_FAILURE(start(""));
  const nlohmann::json file = ask("GET", "/api/v1/rack/file");
  std::string text = file["text"];
  ASSERT_THAT(text, HasSubstr("node_id = 5"));
  text.replace(text.find("spindle"), 7, "conveyor");
  const std::string run = ask("GET", "/api/v1/rack")["run"];
  const std::string path = ask("PUT", "/api/v1/rack/file", text)["path"];
  EXPECT_THAT(path, HasSubstr("running-2.toml"));
  EXPECT_EQ(tests::content(path), text);
  await_run_after(run);
  EXPECT_EQ(ask("GET", "/api/v1/devices")["devices"][0]["name"], "conveyor");
  const nlohmann::json after = ask("GET", "/api/v1/rack/file");
  EXPECT_EQ(after["path"], path);
  EXPECT_EQ(after["text"], text);
  EXPECT_EQ(after["refusal"], "");
  EXPECT_EQ(end(), 0) << log();
  std::filesystem::remove(path);
}

TEST_F(RunningRack, RunsOnIfTheOtherOneCannotStart) {
  ASSERT_NO_FATAL_FAILURE(start(""));
  std::string text = ask("GET", "/api/v1/rack/file")["text"];
  const std::size_t ports = text.find("slcan:");
  text.replace(ports, text.find('"', ports) - ports, "socketcan:no-such-one");
  text.replace(text.find("spindle"), 7, "conveyor");
  const std::string run = ask("GET", "/api/v1/rack")["run"];
  const std::string path = ask("PUT", "/api/v1/rack/file", text)["path"];
  await_run_after(run);
  EXPECT_EQ(ask("GET", "/api/v1/devices")["devices"][0]["name"], "spindle");
  const std::string refusal = ask("GET", "/api/v1/rack/file")["refusal"];
  EXPECT_THAT(refusal, HasSubstr("no-such-one"));
  EXPECT_THAT(log(), HasSubstr(path + " does not start: " + refusal));
  EXPECT_EQ(end(), 0) << log();
  std::filesystem::remove(path);
}

TEST_F(RunningRack, WhoseStateDirectoryIsRemoved_EndsWithStatus1AndSaysSo) {
  const std::string state = tests::temporary("running.state");
  ASSERT_NO_FATAL_FAILURE(start("--state " + state));
  std::filesystem::remove_all(state);
  EXPECT_EQ(end(), 1);
  EXPECT_THAT(log(), HasSubstr(state + ": the state directory has been removed since the rack"));
  EXPECT_THAT(log(), Not(HasSubstr("old content is still there")));
}

TEST_F(RunningRack, WhoseStateDirectoryIsThere_EndsWithStatus0) {
  const std::string state = tests::temporary("running.state");
  ASSERT_NO_FATAL_FAILURE(start("--state " + state));
  EXPECT_EQ(end(), 0) << log();
  std::filesystem::remove_all(state);
}

TEST_F(RunningRack, WithoutRecordingHasNoSnapshots) {
  ASSERT_NO_FATAL_FAILURE(start(""));
  const tests::Outcome outcome = command("snapshot take before");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr("--record"));
}

TEST_F(RunningRack, IsRecordedOnRequest_AndTheRecordingReplaysToTheBit) {
  ASSERT_NO_FATAL_FAILURE(start(""));
  const std::string name = "recorded-" + std::to_string(getpid());
  const std::string file = name + ".stator";
  const std::string body = nlohmann::json{{"name", name}}.dump();
  EXPECT_FALSE(recorded());
  EXPECT_EQ(this->client().request("DELETE", "/api/v1/recording").status, 409);
  ASSERT_NO_FATAL_FAILURE(record(name));
  HttpClient client = this->client();
  EXPECT_THAT(client.request("POST", "/api/v1/recording", body).body, HasSubstr("end that first"));
  EXPECT_EQ(command("snapshot take middle").status, 0);
  EXPECT_EQ(command("inject can-drop --device spindle count=3").status, 0);
  EXPECT_EQ(client.request("DELETE", "/api/v1/recording").status, 200);
  EXPECT_FALSE(recorded());
  EXPECT_EQ(command("snapshot take late").status, 1);
  EXPECT_EQ(command("clear 1").status, 0) << "the rack goes on";
  EXPECT_THAT(client.request("POST", "/api/v1/recording", body).body, HasSubstr(file + " exists"));
  EXPECT_EQ(this->end(), 0) << log();
  const tests::Outcome replayed = tests::stator("replay " + file);
  EXPECT_EQ(replayed.status, 0) << replayed.output;
  EXPECT_THAT(tests::stator("run --duration 10ms --restore " + file + "@middle").output,
              HasSubstr("Going on from "));
  std::filesystem::remove(file);
}

TEST_F(RunningRack, GoesOnWithoutRecordingAfterOneThatWasEnded) {
  ASSERT_NO_FATAL_FAILURE(start(""));
  // A "-" and a number at its end would be taken for that of a run that went on.
  const std::string name = "ended" + std::to_string(getpid());
  const std::string next = name + "-2.stator";
  ASSERT_NO_FATAL_FAILURE(record(name));
  ASSERT_EQ(client().request("DELETE", "/api/v1/recording").status, 200);
  const std::string text = ask("GET", "/api/v1/rack/file")["text"];
  const std::string run = ask("GET", "/api/v1/rack")["run"];
  const std::string path = ask("PUT", "/api/v1/rack/file", text)["path"];
  await_run_after(run);
  EXPECT_FALSE(recorded());
  EXPECT_FALSE(std::filesystem::exists(next));
  EXPECT_EQ(end(), 0) << log();
  std::filesystem::remove(path);
  std::filesystem::remove(name + ".stator");
  std::filesystem::remove(next);
}

TEST_F(RunningRack, GoesBackWithoutRecordingIntoOneThatWasEnded) {
  ASSERT_NO_FATAL_FAILURE(start(""));
  const std::string name = "left" + std::to_string(getpid());
  const std::string next = name + "-2.stator";
  ASSERT_NO_FATAL_FAILURE(record(name));
  ASSERT_EQ(command("snapshot take middle").status, 0);
  ASSERT_EQ(client().request("DELETE", "/api/v1/recording").status, 200);
  const std::string run = ask("GET", "/api/v1/rack")["run"];
  static_cast<void>(ask("POST", "/api/v1/snapshots/middle/restore"));
  await_run_after(run);
  EXPECT_FALSE(recorded());
  EXPECT_FALSE(std::filesystem::exists(next));
  EXPECT_THAT(log(), HasSubstr("Going on from "));
  EXPECT_EQ(end(), 0) << log();
  std::filesystem::remove(name + ".stator");
  std::filesystem::remove(next);
}

TEST_F(RunningRack, IsRecordedAnewAfterAnotherRackWasRunInsteadOfOneThatIsRecorded) {
  ASSERT_NO_FATAL_FAILURE(start(""));
  const std::string name = "going" + std::to_string(getpid());
  const std::string next = name + "-2.stator";
  ASSERT_NO_FATAL_FAILURE(record(name));
  const std::string text = ask("GET", "/api/v1/rack/file")["text"];
  const std::string run = ask("GET", "/api/v1/rack")["run"];
  const std::string path = ask("PUT", "/api/v1/rack/file", text)["path"];
  await_run_after(run);
  EXPECT_TRUE(recorded());
  EXPECT_TRUE(std::filesystem::exists(next));
  EXPECT_EQ(end(), 0) << log();
  std::filesystem::remove(path);
  std::filesystem::remove(name + ".stator");
  std::filesystem::remove(next);
}

TEST_F(RunningRack, ThatWritesOtherFilesIsNotBegunAnewToRecordIt) {
  ASSERT_NO_FATAL_FAILURE(start("--record " + tests::temporary("running.csv")));
  const HttpResponse refused =
      client().request("POST", "/api/v1/recording", R"({"name": "other"})");
  EXPECT_EQ(refused.status, 409);
  EXPECT_THAT(refused.body, HasSubstr("start it with --record NAME.stator"));
}

/// A module whose program lies in a folder beside that of the rack file.
class RecordedRack : public ::testing::Test {
 protected:
  RecordedRack() {
    std::filesystem::create_directories(folder_ + "/racks");
    std::filesystem::create_directories(folder_ + "/programs");
    std::ofstream(folder_ + "/programs/switch.tmc")
        << "SIO 0, 2, 1\nLoop: WAIT TICKS, 0, 1\nJA Loop\n";
  }
  ~RecordedRack() override { std::filesystem::remove_all(folder_); }

  std::string rack(const std::string& program) {
    const std::string path = folder_ + "/racks/module.toml";
    std::ofstream(path) << "[[device]]\ntype = \"tmcm-142\"\nname = \"module\"\nrs485 = \"pty:"
                        << folder_ << "/line\"\nprogram = \"" << program
                        << "\"\nauto_start = true\n";
    return path;
  }

  std::string folder_ = tests::temporary("recorded");
  std::string recording_ = tests::temporary("recorded.stator");
};

TEST_F(RecordedRack, KeepsFilesThatLieAroundItsFolder) {
  const tests::Outcome run = tests::stator("run " + rack("../programs/switch.tmc") +
                                           " --duration 300ms --record " + recording_);
  EXPECT_EQ(run.status, 0) << run.output;
  std::filesystem::remove_all(folder_);
  const std::string csv = tests::temporary("recorded.csv");
  const tests::Outcome replay = tests::stator("replay " + recording_ + " --csv " + csv +
                                              " --period 50ms" + " --signals module.output0");
  EXPECT_EQ(replay.status, 0) << replay.output;
  std::istringstream rows(tests::content(csv));
  std::string last;
  for (std::string row; std::getline(rows, row);) {
    last = row;
  }
  EXPECT_EQ(std::stod(last.substr(last.find(',') + 1)), 1.0) << "its program has set the output";
}

TEST_F(RecordedRack, MayLieInTheFolderInWhichTheProgramIsStarted) {
  static_cast<void>(rack("../programs/switch.tmc"));
  const tests::Outcome run = tests::run_in_shell(
      "cd " + folder_ + "/racks && " STATOR_PROGRAM " run module.toml --duration 50ms --record " +
      recording_ + " 2>&1 </dev/null");
  EXPECT_EQ(run.status, 0) << run.output;
  std::filesystem::remove_all(folder_);
  const tests::Outcome replay = tests::stator("replay " + recording_);
  EXPECT_EQ(replay.status, 0) << replay.output;
}

TEST_F(RecordedRack, ThatWasCutIsReplayedUpToThereWithAStatusOfItsOwn) {
  const tests::Outcome run = tests::stator("run " + rack("../programs/switch.tmc") +
                                           " --duration 300ms --record " + recording_);
  EXPECT_EQ(run.status, 0) << run.output;
  std::filesystem::resize_file(recording_, std::filesystem::file_size(recording_) - 3);
  const tests::Outcome cut = tests::stator("replay " + recording_);
  EXPECT_EQ(cut.status, 3) << cut.output;
  EXPECT_THAT(cut.output, HasSubstr("replayed to the bit up to the cut at 0."));
  EXPECT_THAT(cut.output, HasSubstr("cut off within a chunk"));
  std::filesystem::resize_file(recording_, 0);
  const tests::Outcome empty = tests::stator("replay " + recording_);
  EXPECT_EQ(empty.status, 1);
  EXPECT_THAT(empty.output, HasSubstr("empty recording"));
}

TEST_F(RecordedRack, CannotKeepAFileThatIsNamedFromTheRoot) {
  const tests::Outcome run = tests::stator("run " + rack(folder_ + "/programs/switch.tmc") +
                                           " --duration 10ms --record " + recording_);
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.output, HasSubstr("/programs/switch.tmc\" would lie elsewhere"));
}

}  // namespace
}  // namespace stator::cli
