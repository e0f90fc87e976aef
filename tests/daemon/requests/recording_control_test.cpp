// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <thread>

#include <gmock/gmock.h>

#include "tests/capture/recording/file_size_limit.h"
#include "tests/daemon/requests/recording_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::HasSubstr;

using RecordingControlTest = RecordingTest;

TEST_F(RecordingControlTest, StartsAndStops) {
    EXPECT_THAT(stop().refusal, HasSubstr("nothing is being recorded"));
    EXPECT_EQ(start("a.mkv").refusal, "");
    EXPECT_THAT(start("b.mkv").refusal, HasSubstr("is running"));
    offer(3);
    const Answered end = stop();
    EXPECT_EQ(end.refusal, "");
    EXPECT_FALSE(end.status.active());
    EXPECT_EQ(end.status.frames(), 3U);
    EXPECT_EQ(end.status.error(), "");
    EXPECT_EQ(end.status.bytes(), size_of("a.mkv"));
}

TEST_F(RecordingControlTest, AFileThatWasRemovedIsNotComplete) {
    ASSERT_EQ(start("a.mkv").refusal, "");
    offer(2);
    std::filesystem::remove(folder_.path() + "/a.mkv");
    const Answered end = stop();
    EXPECT_EQ(end.status.frames(), 0U);
    EXPECT_EQ(end.status.dropped(), 2U);
    EXPECT_THAT(end.status.error(), HasSubstr("a.mkv: cannot write: the file was removed while it was written"));
}

TEST_F(RecordingControlTest, WhatASourceThatGoesHasEndedIsFinishedInTheBackground) {
    ASSERT_EQ(start("a.mkv").refusal, "");
    offer(2);
    std::promise<void> go_on = hold_worker();
    control_.set_source(std::nullopt, "the camera has gone");
    EXPECT_TRUE(control_.status().active());
    offer(1);
    Request stopped;
    control_.stop(stopped.answer());
    go_on.set_value();
    const Answered end = stopped.wait();
    EXPECT_EQ(end.refusal, "");
    EXPECT_FALSE(end.status.active());
    EXPECT_EQ(end.status.frames(), 2U);
    EXPECT_EQ(end.status.error(), "the camera has gone");
    EXPECT_EQ(end.status.bytes(), size_of("a.mkv"));
    EXPECT_THAT(stop().refusal, HasSubstr("nothing is being recorded"));
    EXPECT_THAT(start("b.mkv").refusal, HasSubstr("no source"));
}

TEST_F(RecordingControlTest, TheNextOneStartsWhenTheLastIsFinished) {
    ASSERT_EQ(start("a.mkv").refusal, "");
    offer(2);
    std::promise<void> go_on = hold_worker();
    Request started;
    control_.start({"b.mkv"}, started.answer());
    control_.set_source(info_, "another configuration");
    go_on.set_value();
    const Answered second = started.wait();
    EXPECT_EQ(second.refusal, "");
    EXPECT_TRUE(second.status.active());
    EXPECT_THAT(second.status.path(), HasSubstr("b.mkv"));
    offer(1);
    const Answered end = stop();
    EXPECT_EQ(end.status.frames(), 1U);
    EXPECT_EQ(end.status.error(), "");
    EXPECT_EQ(capture::test::replay(folder_.path() + "/a.mkv").frames.size(), 2U);
}

TEST_F(RecordingControlTest, OneThatHasFailedIsFinishedAndTheNextOneCanStart) {
    ASSERT_EQ(start("a.mkv").refusal, "");
    {
        const capture::test::FileSizeLimit full_disk(10'000);
        while (control_.status().error().empty()) {
            offer(1);
        }
        EXPECT_THAT(start("b.mkv").refusal, HasSubstr("is running"));
        control_.check();
        control_.wait();
    }
    EXPECT_FALSE(control_.status().active());
    EXPECT_THAT(control_.status().error(), HasSubstr("File too large"));
    EXPECT_THAT(stop().refusal, HasSubstr("nothing is being recorded"));
    EXPECT_EQ(start("b.mkv").refusal, "");
}

TEST_F(RecordingControlTest, NamesAreThoseOfRecordings) {
    for (const std::string name : {".bash_profile", "-rf", ".a.mkv", "-a.mkv", "_a.mkv", " a.mkv", "sub/.a.mkv",
                                   ".sub/a.mkv", "a", "a.txt", "a.mkv.txt", "a.MKV", ".mkv", "mkv", "a.mkv/"}) {
        EXPECT_THAT(start(name).refusal, HasSubstr("allowed: a new file in " + folder_.path())) << name;
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
    std::filesystem::create_directory(folder_.path() + "/2026");
    for (const std::string name : {"2026/a.mkv", "\xc3\xa4.mkv", "./7.mkv"}) {
        EXPECT_EQ(start(name).refusal, "") << name;
        offer(1);
        EXPECT_EQ(stop().refusal, "");
    }
    EXPECT_TRUE(std::filesystem::exists(folder_.path() + "/2026/a.mkv"));
}

TEST_F(RecordingControlTest, AFolderThatNobodyHasChosenIsForItsOwner) {
    rules_.directory_is_chosen = false;
    control_.configure(rules_);
    EXPECT_THAT(start("a.mkv").refusal, HasSubstr("[record] directory"));
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
    Request request;
    control_.start({"a.mkv", true}, request.answer());
    EXPECT_EQ(request.wait().refusal, "");
}

TEST_F(RecordingControlTest, RecordingsMayEndWhileAFrameIsCopied) {
    std::atomic<bool> done{false};
    std::thread capture([&] {
        while (!done) {
            offer(1);
        }
    });
    for (int i = 0; i < 4; ++i) {
        const std::string name = std::to_string(i) + ".mkv";
        EXPECT_EQ(start(name).refusal, "");
        while (control_.status().active() && control_.status().frames() == 0) {
            std::this_thread::yield();
        }
        control_.set_source(info_, "another configuration");
        control_.wait();
        const v1::RecordStatus end = control_.status();
        EXPECT_FALSE(end.active());
        EXPECT_EQ(end.error(), "another configuration");
        EXPECT_EQ(capture::test::replay(folder_.path() + "/" + name).frames.size(), end.frames());
    }
    done = true;
    capture.join();
}

TEST_F(RecordingControlTest, CanBeWaitedFor) {
    ASSERT_EQ(start("a.mkv").refusal, "");
    offer(2);
    control_.set_source(std::nullopt, "");
    control_.wait();
    EXPECT_FALSE(control_.status().active());
    EXPECT_EQ(control_.status().bytes(), size_of("a.mkv"));
    EXPECT_EQ(capture::test::replay(folder_.path() + "/a.mkv").frames.size(), 2U);
}

}  // namespace
}  // namespace disparityd::test
