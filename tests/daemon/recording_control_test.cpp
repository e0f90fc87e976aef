// SPDX-License-Identifier: Apache-2.0
#include "daemon/recording_control.h"

#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/capture/file_size_limit.h"
#include "tests/capture/record_fixture.h"

namespace disparityd {
namespace {

using capture::test::make_frame;
using capture::test::make_info;
using ::testing::HasSubstr;

struct Answered {
    v1::RecordStatus status;
    std::string refusal;
};

/// One that has not been answered yet may be waited for.
class Request {
public:
    RecordingControl::Answer answer() {
        return [promise = promise_](const v1::RecordStatus& status, const std::string& refusal) {
            promise->set_value({status, refusal});
        };
    }

    Answered wait() { return answered_.get(); }

private:
    std::shared_ptr<std::promise<Answered>> promise_ = std::make_shared<std::promise<Answered>>();
    std::future<Answered> answered_ = promise_->get_future();
};

class RecordingControlTest : public ::testing::Test {
protected:
    RecordingControlTest() {
        control_.configure(true, folder_.path());
        control_.set_source(info_, "");
    }

    Answered start(const std::string& path) {
        Request request;
        control_.start(path, request.answer());
        return request.wait();
    }

    Answered stop() {
        Request request;
        control_.stop(request.answer());
        return request.wait();
    }

    void offer(int frames) {
        for (int i = 0; i < frames; ++i) {
            control_.offer(make_frame(info_, i).frame);
        }
    }

    /// The worker is busy with an answer until the promise is kept.
    std::promise<void> hold_worker() {
        std::promise<void> go_on;
        const auto held = std::make_shared<std::promise<void>>();
        control_.start("", [held, released = go_on.get_future().share()](const auto&, const auto&) {
            held->set_value();
            released.wait();
        });
        held->get_future().wait();
        return go_on;
    }

    std::uintmax_t size_of(const std::string& name) const {
        return std::filesystem::file_size(folder_.path() + "/" + name);
    }

    capture::test::TemporaryFolder folder_;
    capture::SourceInfo info_ = make_info(PixelFormat::grey8, 16, 8);
    RecordingControl control_;
};

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
    control_.start("b.mkv", started.answer());
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
}  // namespace disparityd
