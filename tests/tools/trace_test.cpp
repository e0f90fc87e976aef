// SPDX-License-Identifier: Apache-2.0
//
// disparityctl trace, on a daemon that matches as fast as it can.
#include <fstream>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <unistd.h>

#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"

namespace disparityd::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

class TraceTest : public FolderTest {
protected:
    void SetUp() override {
        FolderTest::SetUp();
        const std::string id = "dctl-trace-" + std::to_string(getpid());
        socket_ = "/tmp/" + id + ".sock";
        daemon_ = std::make_unique<Program>(
            DISPARITYD, std::vector<std::string>{"--source", "scene:vga@1000?width=128&height=96&loop=8", "--name", id,
                                                 "--set", "socket.unix=" + socket_, "--set", "socket.tcp=", "--set",
                                                 "match.disparities=16", "--set", "pipeline.workers=2"});
        ASSERT_TRUE(eventually([this] {
            const Outcome outcome = ctl({"status", "--json"});
            return outcome.exit_code == 0 && nlohmann::json::parse(outcome.out)["published"] > 0;
        }));
    }

    void TearDown() override {
        daemon_->send(SIGTERM);
        daemon_->wait();
        FolderTest::TearDown();
    }

    Outcome ctl(std::vector<std::string> arguments) const {
        arguments.insert(arguments.end(), {"--socket", "unix:" + socket_});
        return run(DISPARITYCTL, arguments);
    }

    std::string socket_;
    std::unique_ptr<Program> daemon_;
};

TEST_F(TraceTest, HasEveryStageStepAndQueue) {
    const Outcome outcome = ctl({"trace", "-o", path("trace.json"), "--seconds", "0.5"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr(path("trace.json")), HasSubstr("events in 0.5 s")));
    std::ifstream file(path("trace.json"));
    const nlohmann::json trace = nlohmann::json::parse(file);

    std::map<std::string, std::set<std::string>> names;
    std::set<std::string> threads;
    for (const nlohmann::json& event : trace["traceEvents"]) {
        if (event["name"] == "thread_name") {
            threads.insert(event["args"]["name"]);
        } else if (event.contains("cat")) {
            names[event["cat"]].insert(event["name"]);
        }
    }
    EXPECT_EQ(threads,
              (std::set<std::string>{"capture", "rectify", "census", "match", "post-process", "publish", "worker 1"}));
    EXPECT_THAT(names["stage"], IsSupersetOf({"capture", "rectify", "census", "match", "post-process", "publish"}));
    EXPECT_THAT(names["queue"], IsSupersetOf({"queue: rectify", "queue: match", "queue: publish"}));
    EXPECT_THAT(names["frame"], IsSupersetOf({"frame"}));
    // Added stages are the work of the threads beside them.
    names["step"].insert(names["stage"].begin(), names["stage"].end());
    const nlohmann::json status = nlohmann::json::parse(ctl({"status", "--json"}).out);
    for (const nlohmann::json& step : status["steps"]) {
        const std::string name = step["name"];
        if (name != "capture" && name != "publish" && name != "total" && name.rfind("wait-", 0) != 0) {
            EXPECT_THAT(names["step"], IsSupersetOf({name}));
        }
    }
}

TEST_F(TraceTest, RefusesWhatCannotBe) {
    EXPECT_EQ(ctl({"trace", "-o", path("trace.json"), "--seconds", "11"}).exit_code, 2);
    EXPECT_EQ(ctl({"trace", "--seconds", "1"}).exit_code, 2) << "no file";
    std::ofstream(path("there.json")) << "mine";
    const Outcome kept = ctl({"trace", "-o", path("there.json"), "--seconds", "0.1"});
    EXPECT_EQ(kept.exit_code, 2);
    EXPECT_THAT(kept.err, HasSubstr("exists already"));
    const Outcome nowhere = ctl({"trace", "-o", path("no/folder/trace.json"), "--seconds", "0.1"});
    EXPECT_EQ(nowhere.exit_code, 2);
    EXPECT_THAT(nowhere.err, HasSubstr("no/folder is not there"));
    EXPECT_EQ(ctl({"trace", "-o", path("there.json"), "--seconds", "0.1", "--force"}).exit_code, 0);
}

}  // namespace
}  // namespace disparityd::test
