// SPDX-License-Identifier: Apache-2.0
#include <disparity_client.h>
#include <disparity_client.hpp>
#include <gtest/gtest.h>

#include "tests/proto/fake_daemon.h"
#include "tests/proto/sensor_pattern.h"

namespace v1 = disparityd::v1;
using disparity::ReadResult;
using namespace std::chrono_literals;

namespace {

constexpr auto sample_patience = 20s;

/// Answers each status request with `count` messages of sensors before it.
FakeDaemon::Script sends(int count, bool subscribed) {
    return [=](ServerEnd& end) {
        end.greet();
        v1::Envelope envelope;
        end.receive(envelope);
        EXPECT_EQ(envelope.subscribe().sensors(), subscribed);
        while (end.receive(envelope)) {
            for (int i = 0; i < count; ++i) {
                end.send(sensor_message());
            }
            v1::Envelope answer;
            answer.mutable_status()->set_state("running");
            end.send(answer);
        }
    };
}

void subscribe(disparity::SocketClient& client, bool sensors) {
    disparity::Subscription subscription;
    subscription.sensors = sensors;
    client.subscribe(subscription);
}

TEST(SensorClient, SamplesCarryWhatWasMeasured) {
    FakeDaemon daemon(sends(1, true));
    disparity::SocketClient client(daemon.unix_address());
    subscribe(client, true);
    client.status(sample_patience);
    disparity::SensorBatch batch;
    ASSERT_EQ(client.read_sensors(batch, sample_patience), ReadResult::frame);
    EXPECT_EQ(batch.skipped, 3U);
    EXPECT_EQ(batch.age_ns, 5000);
    ASSERT_EQ(batch.samples.size(), 2U);
    const disparity::SensorSample& first = batch.samples[0];
    EXPECT_EQ(first.monotonic_ns, 1000);
    EXPECT_EQ(first.realtime_ns, 2000);
    EXPECT_EQ(first.camera_ns, 3000);
    EXPECT_EQ(first.lost_before, 4U);
    EXPECT_FALSE(first.frame_sync);
    ASSERT_TRUE(first.inertial);
    EXPECT_EQ(first.inertial->angular_velocity.x, 0.5F);
    EXPECT_EQ(first.inertial->acceleration.z, 9.75F);
    EXPECT_EQ(first.inertial->celsius, 31);
    EXPECT_FALSE(first.environment || first.magnetic_field || first.eye_temperatures);
    const disparity::SensorSample& second = batch.samples[1];
    EXPECT_TRUE(second.frame_sync);
    EXPECT_EQ(second.frame_syncs, 7U);
    EXPECT_FALSE(second.inertial);
    ASSERT_TRUE(second.environment);
    EXPECT_EQ(second.environment->hectopascal, 1013.25F);
    EXPECT_EQ(client.read_sensors(batch, 0ms), ReadResult::timeout);
}

TEST(SensorClient, WhatNobodyReadsIsBoundedAndCounted) {
    FakeDaemon daemon(sends(5000, true));
    disparity::SocketClient client(daemon.unix_address());
    subscribe(client, true);
    client.status(sample_patience);
    std::uint64_t samples = 0;
    std::uint64_t skipped = 0;
    for (disparity::SensorBatch batch; client.read_sensors(batch, 0ms) == ReadResult::frame;) {
        samples += batch.samples.size();
        skipped += batch.skipped;
    }
    EXPECT_EQ(samples, 8192U);
    EXPECT_EQ(samples + skipped, 5000U * (2 + 3));
}

TEST(SensorClient, NobodyGetsThemWhoDoesNotAsk) {
    FakeDaemon daemon(sends(0, false));
    disparity::SocketClient client(daemon.tcp_address());
    subscribe(client, false);
    client.status(sample_patience);
    disparity::SensorBatch batch;
    EXPECT_EQ(client.read_sensors(batch, 0ms), ReadResult::timeout);
}

/// Numbers that doubles have exactly.
v1::Status calibrated_status() {
    v1::Status status;
    status.mutable_geometry()->set_calibration_id(77);
    v1::InertialCalibration& inertial = *status.mutable_inertial_calibration();
    for (const double number : {0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0}) {
        inertial.mutable_pose()->add_rotation(number);
    }
    for (const double number : {10.5, -20.0, 0.25}) {
        inertial.mutable_pose()->add_translation_mm(number);
    }
    inertial.mutable_time_offset()->set_seconds(0);
    inertial.set_gyroscope_random_walk(0.5);
    return status;
}

TEST(InertialCalibration, IsReadFromAStatusInCppAndC) {
    const std::string bytes = calibrated_status().SerializeAsString();
    const auto found = disparity::inertial_calibration(bytes);
    ASSERT_TRUE(found && found->pose);
    EXPECT_EQ(found->calibration_id, 77U);
    EXPECT_EQ(found->pose->rotation, (std::array<double, 9>{0, -1, 0, 1, 0, 0, 0, 0, 1}));
    EXPECT_EQ(found->pose->translation_mm, (std::array<double, 3>{10.5, -20, 0.25}));
    EXPECT_EQ(found->time_offset_s, 0) << "known, though it is 0";
    EXPECT_EQ(found->gyroscope_random_walk, 0.5);
    EXPECT_FALSE(found->gyroscope_noise_density || found->accelerometer_noise_density ||
                 found->accelerometer_random_walk);
    disparity_inertial_calibration in_c;
    ASSERT_EQ(disparity_inertial_calibration_of(bytes.data(), bytes.size(), &in_c, sizeof in_c), 1);
    EXPECT_EQ(in_c.calibration_id, 77U);
    EXPECT_EQ(in_c.holds, static_cast<std::uint32_t>(DISPARITY_INERTIAL_POSE | DISPARITY_INERTIAL_TIME_OFFSET));
    EXPECT_EQ(in_c.rotation[3], 1);
    EXPECT_EQ(in_c.translation_mm[1], -20);
    EXPECT_EQ(in_c.gyroscope_random_walk, 0.5);
    EXPECT_EQ(in_c.accelerometer_random_walk, 0);
}

TEST(InertialCalibration, WhatIsUnknownIsAbsent) {
    v1::Status status = calibrated_status();
    status.mutable_inertial_calibration()->clear_time_offset();
    status.mutable_inertial_calibration()->mutable_pose()->mutable_rotation()->RemoveLast();
    const std::string bytes = status.SerializeAsString();
    const auto found = disparity::inertial_calibration(bytes);
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->pose || found->time_offset_s);
    disparity_inertial_calibration in_c;
    ASSERT_EQ(disparity_inertial_calibration_of(bytes.data(), bytes.size(), &in_c, sizeof in_c), 1);
    EXPECT_EQ(in_c.holds, 0U);
    EXPECT_FALSE(disparity::inertial_calibration(v1::Status().SerializeAsString()));
    EXPECT_EQ(disparity_inertial_calibration_of("", 0, &in_c, sizeof in_c), 0);
    EXPECT_EQ(in_c.gyroscope_random_walk, 0);
    EXPECT_THROW(disparity::inertial_calibration("no status"), std::invalid_argument);
    EXPECT_EQ(disparity_inertial_calibration_of("no status", 9, &in_c, sizeof in_c), DISPARITY_ERROR);
    EXPECT_EQ(disparity_inertial_calibration_of(nullptr, 0, &in_c, sizeof in_c), DISPARITY_ERROR);
}

}  // namespace
