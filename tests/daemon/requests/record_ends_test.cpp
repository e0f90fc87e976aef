// SPDX-License-Identifier: Apache-2.0
//
// What ends a recording of the real daemon that nobody stops.
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>

#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::HasSubstr;
using namespace std::chrono_literals;

class RecordEndsTest : public DaemonTest {
protected:
    /// Its status once it has ended.
    static v1::RecordStatus wait_for_end(WireClient& observer) {
        const auto end = std::chrono::steady_clock::now() + 60s;
        while (status(observer).record().active() && std::chrono::steady_clock::now() < end) {
            std::this_thread::sleep_for(20ms);
        }
        return status(observer).record();
    }

    static void wait_for_frames(WireClient& observer, std::uint64_t frames) {
        const auto end = std::chrono::steady_clock::now() + 60s;
        while (status(observer).record().frames() < frames) {
            ASSERT_LT(std::chrono::steady_clock::now(), end) << status(observer).record().error();
            std::this_thread::sleep_for(20ms);
        }
    }

    static WireClient connected(const DaemonProcess& daemon) {
        WireClient client(daemon.address("unix:"));
        client.hello();
        return client;
    }
};

TEST_F(RecordEndsTest, ItsClientIsGone) {
    const std::string gone = "[record] when_client_is_gone";
    for (const bool stops : {false, true}) {
        const auto daemon =
            start_ready(config_text() + "when_client_is_gone = \"" + (stops ? "stop" : "go-on") + "\"\n");
        WireClient observer = connected(*daemon);
        {
            WireClient client = connected(*daemon);
            ASSERT_TRUE(client.record(stops ? "stops.mkv" : "goes-on.mkv"));
            wait_for_frames(observer, 1);
        }
        if (stops) {
            EXPECT_THAT(wait_for_end(observer).error(), HasSubstr(gone));
            EXPECT_THAT(daemon->log(), HasSubstr(gone));
        } else {
            wait_for_frames(observer, 1 + status(observer).record().frames());
            EXPECT_TRUE(status(observer).record().active());
            EXPECT_TRUE(observer.record("")) << "somebody else may stop it";
        }
    }
}

TEST_F(RecordEndsTest, ALimitIsReached) {
    const auto daemon = start_ready(config_text() + "max_s = 1\n");
    WireClient client = connected(*daemon);
    ASSERT_TRUE(client.record("a.mkv"));
    const v1::RecordStatus end = wait_for_end(client);
    EXPECT_FALSE(end.active());
    EXPECT_GT(end.frames(), 0U);
    EXPECT_THAT(end.error(), HasSubstr("[record] max_s = 1"));
    EXPECT_TRUE(daemon->wait_for_log("[record] max_s = 1"));
    EXPECT_TRUE(client.record("b.mkv")) << "the next one may begin";
}

TEST_F(RecordEndsTest, TheDiskWouldGetTooFull) {
    const auto daemon = start_ready(config_text() + "keep_free_mb = 100000000\n");
    WireClient client = connected(*daemon);
    EXPECT_FALSE(client.record("a.mkv"));
    EXPECT_FALSE(std::filesystem::exists(folder_.path() + "/a.mkv"));
    EXPECT_TRUE(daemon->wait_for_log("allowed: at least 100000000 MB ([record] keep_free_mb)")) << daemon->log();
}

}  // namespace
}  // namespace disparityd::test
