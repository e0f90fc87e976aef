// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <unistd.h>

#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"

namespace disparityd::test {

/// A daemon on a small scene, with a socket and shared memory of its own.
class DaemonTest : public FolderTest {
protected:
    virtual std::string source() const { return "scene:vga@30?width=128&height=96&loop=8"; }
    /// Further settings of the daemon, "section.key=value".
    virtual std::vector<std::string> settings() const { return {}; }
    virtual void wait_for_frames() {
        ASSERT_TRUE(eventually([this] { return status()["published"] > 0; }));
    }

    void SetUp() override {
        FolderTest::SetUp();
        // Short, because socket paths are; unique, because tests run side by side.
        socket_ = "/tmp/dctl-test-" + std::to_string(getpid()) + ".sock";
        name_ = "dctl-test-" + std::to_string(getpid());
        std::filesystem::create_directory(path("recordings"));
        std::vector<std::string> all{"--source", source(), "--name", name_};
        for (const std::string& setting :
             {"socket.unix=" + socket_, std::string("socket.tcp="), std::string("match.disparities=16"),
              "record.directory=" + path("recordings")}) {
            all.insert(all.end(), {"--set", setting});
        }
        for (const std::string& setting : settings()) {
            all.insert(all.end(), {"--set", setting});
        }
        daemon_ = std::make_unique<Program>(DISPARITYD, all);
        const bool up = eventually([this] { return !daemon_->running() || ctl("status", {}).exit_code == 0; });
        ASSERT_TRUE(up && daemon_->running()) << daemon_->wait().err;
        wait_for_frames();
    }

    void TearDown() override {
        if (daemon_ && daemon_->running()) {
            daemon_->send(SIGTERM);
            daemon_->wait();
        }
        FolderTest::TearDown();
    }

    std::vector<std::string> arguments(const std::string& command, std::vector<std::string> more) const {
        more.insert(more.begin(), {command, "--name", name_});
        if (command != "watch" && command != "snapshot") {
            more.insert(more.end(), {"--socket", "unix:" + socket_});
        }
        return more;
    }

    Outcome ctl(const std::string& command, const std::vector<std::string>& more) const {
        return run(DISPARITYCTL, arguments(command, more));
    }

    nlohmann::json status() const { return nlohmann::json::parse(ctl("status", {"--json"}).out); }
    /// Of the recording that runs.
    int recorded_frames() const {
        const nlohmann::json record = status()["record"];
        return record["active"] == true ? record["frames"].get<int>() : 0;
    }

    std::string socket_;
    std::string name_;
    std::unique_ptr<Program> daemon_;
};

}  // namespace disparityd::test
