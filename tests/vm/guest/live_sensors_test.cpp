// SPDX-License-Identifier: Apache-2.0
//
// The sensors of a live camera, through the kernel's hidraw and the daemon, as a client gets them.
#include <cmath>
#include <cstdio>
#include <optional>

#include <gtest/gtest.h>

#include "tests/vm/camera/sensor_report.h"
#include "tests/vm/guest/camera_process.h"
#include "tests/vm/guest/live_daemon.h"

namespace vm_guest {
namespace {

using Status = LiveDaemon::Status;

// The number that the simulated gyroscope shows.
std::int64_t number_of(const disparity::SensorSample& sample) {
    return std::lround(static_cast<double>(sample.inertial->angular_velocity.x) /
                       simulated_camera::angular_velocity_per_number);
}

class LiveSensors : public testing::Test {
protected:
    LiveSensors() {
        disparity::Subscription subscription;
        subscription.products = {disparity::Product::left};
        subscription.status_interval_s = 0.1;
        subscription.sensors = true;
        daemon_.client().subscribe(subscription);
    }

    void TearDown() override {
        if (HasFailure()) {
            std::printf("%s%s\n", daemon_.log().c_str(), in_words(daemon_.status()).c_str());
        }
    }

    bool stream() {
        return daemon_.wait_for([](const Status& status) { return status.sensors().state() == "streaming"; });
    }

    // So many samples in a row, each checked.
    void expect_samples(int count) {
        while (count > 0) {
            disparity::SensorBatch batch;
            ASSERT_EQ(daemon_.client().read_sensors(batch, patience), disparity::ReadResult::frame);
            EXPECT_EQ(batch.skipped, 0U);
            for (const disparity::SensorSample& sample : batch.samples) {
                check(sample);
                --count;
            }
        }
    }

    void check(const disparity::SensorSample& sample) {
        ASSERT_TRUE(sample.inertial);
        EXPECT_NEAR(sample.inertial->acceleration.z, 9.80665, 1e-4);
        if (sample.environment) {
            ++environments_;
            EXPECT_NEAR(sample.environment->hectopascal, 1013.25, 1e-2);
            EXPECT_NEAR(sample.eye_temperatures->left_celsius, 39.5, 1e-3);
            EXPECT_NEAR(sample.magnetic_field->x, 20, 1e-3);
        }
        // The camera has cut its time down to a tick. The rest is the quickest way through an emulated machine.
        const std::int64_t measured = sample.camera_ns - simulated_camera::sensor_clock_ahead_ns;
        EXPECT_GE(sample.monotonic_ns, measured);
        EXPECT_LT(sample.monotonic_ns, measured + 500'000'000);
        EXPECT_EQ(sample.lost_before, 0U);
        if (last_) {
            gaps_ += number_of(sample) == number_of(*last_) + 1 ? 0 : 1;
            EXPECT_GT(sample.monotonic_ns, last_->monotonic_ns);
        }
        last_ = sample;
    }

    CameraProcess camera_{{"--model", "zed2", "--serial", "30303", "--sensors"}};
    LiveDaemon daemon_{"v4l2:vga@15?serial=30303", "/vm/disparityd", {"source.stall_ms=15000"}};
    std::optional<disparity::SensorSample> last_;
    int gaps_ = 0;
    int environments_ = 0;
};

TEST_F(LiveSensors, AClientGetsEverySampleWithItsTimeAlsoAfterAReplug) {
    ASSERT_TRUE(stream());
    EXPECT_EQ(daemon_.status().sensors().node().find("/dev/hidraw"), 0U);
    expect_samples(150);
    EXPECT_EQ(gaps_, 0);
    camera_.unplug();
    EXPECT_TRUE(daemon_.wait_for([](const Status& status) { return !status.has_sensors(); }));
    camera_.plug();
    ASSERT_TRUE(stream());
    // What was measured before the camera went still comes; then it counts anew.
    for (int batches = 0; batches < 1000 && gaps_ == 0; ++batches) {
        expect_samples(1);
    }
    expect_samples(50);
    EXPECT_EQ(gaps_, 1);
    EXPECT_GT(environments_, 10);
    const Status status = daemon_.status();
    EXPECT_EQ(status.sensors().refused(), 0U);
    std::printf(
        "sensors: drift %.1f ppm, %.2f ms late\n", status.sensors().drift_ppm(),
        static_cast<double>(last_->monotonic_ns - last_->camera_ns + simulated_camera::sensor_clock_ahead_ns) / 1e6);
}

}  // namespace
}  // namespace vm_guest
