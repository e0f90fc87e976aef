// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/guest/live_fixture.h"

#include <cstdio>

namespace vm_guest {

std::unique_ptr<CameraProcess> LiveTest::camera_;
std::unique_ptr<LiveDaemon> LiveTest::daemon_;
LiveDaemon::Resources LiveTest::at_start_;

void LiveTest::start(const std::vector<std::string>& settings) {
    camera_ = std::make_unique<CameraProcess>();
    daemon_ = std::make_unique<LiveDaemon>("v4l2:vga@15", "/vm/disparityd", settings);
    // The first time, what is made once is made.
    EXPECT_TRUE(streams());
    camera_->unplug();
    EXPECT_TRUE(daemon_->wait_for_camera("absent"));
    camera_->plug();
    EXPECT_TRUE(streams()) << daemon_->log();
    at_start_ = daemon_->resources();
}

void LiveTest::TearDownTestSuite() {
    if (daemon_) {
        EXPECT_TRUE(streams());
        EXPECT_TRUE(daemon_->comes_back_to(at_start_)) << at_start_ << "; now " << daemon_->resources();
    }
    daemon_.reset();
    camera_.reset();
}

void LiveTest::TearDown() {
    if (HasFailure()) {
        std::printf("%s%s\n", daemon_->log().c_str(), in_words(daemon_->status()).c_str());
    }
}

bool LiveTest::streams() {
    return daemon_->wait_for_camera("streaming") && daemon_->wait_for_new_frame() &&
           number_of_left_picture(*daemon_->frame().plane(disparity::Product::left)).has_value();
}

}  // namespace vm_guest
