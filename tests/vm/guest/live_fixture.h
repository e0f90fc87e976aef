// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "tests/vm/guest/camera_process.h"
#include "tests/vm/guest/live_daemon.h"

namespace vm_guest {

/// A camera, a daemon on it and its client, one of each for all tests of a suite, at whose end the daemon holds no more
/// than at its beginning. A failed test shows the daemon's log.
class LiveTest : public testing::Test {
protected:
    using Status = LiveDaemon::Status;

    static void start(const std::vector<std::string>& settings);
    static void TearDownTestSuite();
    void TearDown() override;

    /// Frames come, and the one that came last is whole.
    static bool streams();

    static std::unique_ptr<CameraProcess> camera_;
    static std::unique_ptr<LiveDaemon> daemon_;

private:
    static LiveDaemon::Resources at_start_;
};

}  // namespace vm_guest
