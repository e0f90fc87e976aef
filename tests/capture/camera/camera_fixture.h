// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "capture/camera/camera_source.h"
#include "capture/source_condition.h"
#include "tests/capture/camera/fake_camera.h"

namespace disparityd::capture::test {

/// A source of cameras that are not real, and what it told.
class FakeCameraTest : public ::testing::Test {
protected:
    CameraFacts facts() const { return *source_->condition().camera; }
    std::string detail() const { return source_->condition().detail; }

    int reported(const std::string& part) const {
        return static_cast<int>(std::count_if(reports_.begin(), reports_.end(), [&](const std::string& line) {
            return line.find(part) != std::string::npos;
        }));
    }

    FakeVideoSystem system_;
    std::vector<std::string> reports_;
    std::unique_ptr<FrameSource> source_;
    RawFrame last_;
};

}  // namespace disparityd::capture::test
