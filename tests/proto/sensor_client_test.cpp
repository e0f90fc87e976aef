// SPDX-License-Identifier: Apache-2.0
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

}  // namespace
