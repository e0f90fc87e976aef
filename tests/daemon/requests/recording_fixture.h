// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "daemon/requests/recording_control.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::test {

struct Answered {
    v1::RecordStatus status;
    std::string refusal;
};

/// One that has not been answered yet may be waited for.
class Request {
public:
    daemon::RecordingControl::Answer answer() {
        return [promise = promise_](const v1::RecordStatus& status, const std::string& refusal) {
            promise->set_value({status, refusal});
        };
    }

    Answered wait() { return answered_.get(); }

private:
    std::shared_ptr<std::promise<Answered>> promise_ = std::make_shared<std::promise<Answered>>();
    std::future<Answered> answered_ = promise_->get_future();
};

/// Records small frames into a folder of its own.
class RecordingTest : public ::testing::Test {
protected:
    RecordingTest() {
        rules_.directory = folder_.path();
        control_.configure(rules_);
        control_.set_source(info_, "");
    }

    Answered start(const std::string& path, std::uint64_t client = 0) {
        Request request;
        control_.start({path, false, client}, request.answer());
        return request.wait();
    }

    Answered stop() {
        Request request;
        control_.stop(request.answer());
        return request.wait();
    }

    void offer(int frames) {
        for (int i = 0; i < frames; ++i) {
            control_.offer(capture::test::make_frame(info_, i).frame);
        }
    }

    /// The worker is busy with an answer until the promise is kept.
    std::promise<void> hold_worker() {
        std::promise<void> go_on;
        const auto held = std::make_shared<std::promise<void>>();
        control_.start({}, [held, released = go_on.get_future().share()](const auto&, const auto&) {
            held->set_value();
            released.wait();
        });
        held->get_future().wait();
        return go_on;
    }

    bool exists(const std::string& name) const { return std::filesystem::exists(folder_.path() + "/" + name); }

    std::uintmax_t size_of(const std::string& name) const {
        return std::filesystem::file_size(folder_.path() + "/" + name);
    }

    capture::test::TemporaryFolder folder_;
    capture::SourceInfo info_ = capture::test::make_info(PixelFormat::grey8, 16, 8);
    daemon::RecordRules rules_;
    daemon::RecordingControl control_;
};

}  // namespace disparityd::test
