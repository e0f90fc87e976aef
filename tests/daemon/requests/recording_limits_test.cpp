// SPDX-License-Identifier: Apache-2.0
//
// What keeps recordings from filling a disk, a folder or the log, whatever clients ask for.
#include <chrono>
#include <filesystem>

#include <gmock/gmock.h>

#include "daemon/requests/record_request.h"
#include "tests/daemon/requests/recording_fixture.h"

namespace disparityd::test {
namespace {

using std::chrono::steady_clock;
using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

class RecordingLimitsTest : public RecordingTest {
protected:
    /// Until the daemon would have ended it; the status then.
    v1::RecordStatus offer_until_it_ends() {
        const auto end = steady_clock::now() + std::chrono::minutes(1);
        while (control_.status().active() && steady_clock::now() < end) {
            offer(1);
            control_.check();
            control_.wait();
        }
        EXPECT_FALSE(control_.status().active()) << "within a minute";
        return control_.status();
    }
};

TEST_F(RecordingLimitsTest, FiveMayStartAtOnceThenOneASecond) {
    const daemon::Request request = daemon::record_start_request(control_);
    const steady_clock::time_point now = steady_clock::now();
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(request.rate->wait(now).count(), 0) << i;
        request.rate->take(1, now);
    }
    EXPECT_EQ(request.rate->wait(now), 1s);
    EXPECT_EQ(request.rate->wait(now + 1s).count(), 0);
}

TEST_F(RecordingLimitsTest, OneWithoutAFrameLeavesNoFile) {
    ASSERT_EQ(start("a.mkv").refusal, "");
    EXPECT_TRUE(exists("a.mkv"));
    const Answered end = stop();
    EXPECT_EQ(end.refusal, "");
    EXPECT_EQ(end.status.frames(), 0U);
    EXPECT_TRUE(end.status.removed());
    EXPECT_FALSE(exists("a.mkv"));
    EXPECT_TRUE(control_.status().removed());

    ASSERT_EQ(start("a.mkv").refusal, "");
    offer(1);
    EXPECT_FALSE(stop().status.removed());
    EXPECT_TRUE(exists("a.mkv"));
}

TEST_F(RecordingLimitsTest, EndsAtItsSize) {
    rules_.max_bytes = 20'000;
    control_.configure(rules_);
    ASSERT_EQ(start("a.mkv").refusal, "");
    const v1::RecordStatus end = offer_until_it_ends();
    EXPECT_THAT(end.error(), HasSubstr("[record] max_mb"));
    EXPECT_GE(end.bytes(), rules_.max_bytes);
    EXPECT_EQ(capture::test::replay(folder_.path() + "/a.mkv").frames.size(), end.frames());
}

TEST_F(RecordingLimitsTest, EndsAfterItsTime) {
    rules_.max_time = std::chrono::seconds(1);
    control_.configure(rules_);
    const auto begin = steady_clock::now();
    ASSERT_EQ(start("a.mkv").refusal, "");
    const v1::RecordStatus end = offer_until_it_ends();
    EXPECT_GE(steady_clock::now() - begin, rules_.max_time);
    EXPECT_THAT(end.error(), HasSubstr("[record] max_s = 1"));
    EXPECT_GT(end.frames(), 0U);
}

TEST_F(RecordingLimitsTest, StopsBeforeTheDiskIsFull) {
    ASSERT_EQ(start("a.mkv").refusal, "");
    offer(3);
    rules_.keep_free_bytes = std::uint64_t{1} << 60;
    control_.configure(rules_);
    const v1::RecordStatus end = offer_until_it_ends();
    EXPECT_THAT(end.error(), AllOf(HasSubstr("MB are free"), HasSubstr("[record] keep_free_mb")));
    EXPECT_GE(end.frames(), 3U);
    EXPECT_EQ(capture::test::replay(folder_.path() + "/a.mkv").frames.size(), end.frames());

    EXPECT_THAT(start("b.mkv").refusal, AllOf(HasSubstr("b.mkv"), HasSubstr("[record] keep_free_mb")));
    EXPECT_FALSE(exists("b.mkv"));
    rules_.keep_free_bytes = 1;
    control_.configure(rules_);
    EXPECT_EQ(start("b.mkv").refusal, "");
}

TEST_F(RecordingLimitsTest, EndsWithItsClientWhereConfigured) {
    constexpr std::uint64_t client = 7;
    ASSERT_EQ(start("a.mkv", client).refusal, "");
    EXPECT_TRUE(control_.is_recording_for(client));
    EXPECT_FALSE(control_.is_recording_for(8));
    offer(1);
    control_.client_is_gone(client);
    control_.wait();
    EXPECT_TRUE(control_.status().active()) << "it goes on by default";

    rules_.ends_with_client = true;
    control_.configure(rules_);
    control_.client_is_gone(8);
    control_.wait();
    EXPECT_TRUE(control_.status().active());
    control_.client_is_gone(client);
    control_.wait();
    EXPECT_FALSE(control_.status().active());
    EXPECT_FALSE(control_.is_recording_for(client));
    EXPECT_THAT(control_.status().error(), HasSubstr("[record] when_client_is_gone"));
    EXPECT_TRUE(exists("a.mkv"));
}

}  // namespace
}  // namespace disparityd::test
