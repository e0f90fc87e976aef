// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "tests/capture/camera/camera_fixture.h"

namespace disparityd::capture::test {

inline constexpr const char* left_node = "/dev/video0";
inline constexpr const char* right_node = "/dev/video2";
inline constexpr const char* pair_uri = "v4l2:64x16@30?left=/dev/video0&right=/dev/video2";

/// Two cameras that are the eyes of one source.
class CameraPairTest : public FakeCameraTest {
protected:
    CameraPairTest() {
        plug(left_node, "1-1", "A1");
        plug(right_node, "1-2", "B2");
    }

    FakeVideoSystem::Camera& plug(const std::string& node, const std::string& port, const std::string& serial) {
        FakeVideoSystem::Camera camera;
        camera.usb.node = node;
        camera.usb.name = "USB Camera";
        camera.usb.port = port;
        camera.usb.vendor = 0x1234;
        camera.usb.serial = serial;
        camera.usb.speed_mbit = 480;
        camera.usb.bus = 1;
        camera.usb.address = static_cast<int>(port.back());
        return system_.plug(camera);
    }

    FakeVideoSystem::Camera& left() { return system_.camera(left_node); }
    FakeVideoSystem::Camera& right() { return system_.camera(right_node); }

    void open(const std::string& uri = pair_uri, SourceOptions options = {}) {
        options.uri = uri;
        options.loans = 4;
        options.wait_for_camera = true;
        options.decoders = 0;
        options.report = [this](const std::string& line, bool) { reports_.push_back(line); };
        source_.reset();
        source_ = open_camera_on(system_, options);
    }

    /// Waits for a frame, at most this long.
    bool next(RawFrame& frame, std::chrono::milliseconds most = std::chrono::seconds(3)) {
        for (const auto until = system_.now() + most; system_.now() < until;) {
            if (source_->next(frame, std::min(until, system_.now() + std::chrono::milliseconds(100))) ==
                FrameSource::Next::frame) {
                return true;
            }
        }
        return false;
    }

    /// Runs for this long, giving every frame back; how many came.
    int run(std::chrono::milliseconds time) {
        int frames = 0;
        RawFrame frame;
        for (const auto until = system_.now() + time;
             system_.now() < until && next(frame, std::chrono::duration_cast<std::chrono::milliseconds>(
                                                      until - system_.now() + std::chrono::microseconds(999)));) {
            ++frames;
            last_ = frame;
            source_->give_back(frame);
        }
        return frames;
    }

    std::vector<std::string> notices() const { return source_->condition().notices; }
};

}  // namespace disparityd::capture::test
