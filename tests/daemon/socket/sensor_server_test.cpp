// SPDX-License-Identifier: Apache-2.0
//
// Samples of the camera's sensors on their way through the server.

#include "tests/daemon/socket/server_fixture.h"

namespace disparityd::test {
namespace {

using namespace std::chrono_literals;

class SensorServerTest : public ServerTest {
protected:
    /// Numbered by the camera's clock.
    void publish(std::size_t count) {
        std::vector<capture::SensorSample> samples(count);
        for (capture::SensorSample& sample : samples) {
            sample.camera_ns = next_++;
            sample.flags = capture::sensor_flag_inertial;
            sample.acceleration.z = 9.75F;
        }
        server_->publish_sensors(samples, std::chrono::steady_clock::now());
    }

    static v1::Envelope sensors_and(const std::vector<v1::Product>& products) {
        v1::Envelope message = subscription(products);
        message.mutable_subscribe()->set_sensors(true);
        return message;
    }

    static std::optional<v1::Sensors> receive(WireClient& client) {
        while (const auto message = client.receive()) {
            if (message->envelope.has_sensors()) {
                return message->envelope.sensors();
            }
        }
        return std::nullopt;
    }

    std::int64_t next_ = 0;
};

TEST_F(SensorServerTest, SamplesComeInOrderToThoseWhoAsk) {
    start();
    WireClient listener = connect(tcp_);
    WireClient other = connect(unix_);
    subscribe(listener, sensors_and({}));
    subscribe(other, subscription({}));
    std::int64_t expected = 0;
    for (const std::size_t count : {1U, 27U, 400U}) {
        publish(count);
        const auto sensors = receive(listener);
        ASSERT_TRUE(sensors);
        ASSERT_EQ(sensors->samples_size(), static_cast<int>(count));
        EXPECT_EQ(sensors->skipped(), 0U);
        EXPECT_GE(sensors->age_ns(), 0);
        for (const v1::SensorSample& sample : sensors->samples()) {
            EXPECT_EQ(sample.camera_ns(), expected++);
            EXPECT_EQ(sample.inertial().acceleration().z(), 9.75F);
            EXPECT_FALSE(sample.has_environment());
        }
    }
    status(other);
    EXPECT_FALSE(other.receive(0ms)) << "nothing was on its way to who has not asked";
}

TEST_F(SensorServerTest, TheyBeginWithTheSubscriptionAndEndWithIt) {
    start();
    WireClient client = connect(tcp_);
    publish(5);
    subscribe(client, sensors_and({}));
    publish(2);
    auto sensors = receive(client);
    ASSERT_TRUE(sensors);
    EXPECT_EQ(sensors->samples(0).camera_ns(), 5);
    // A subscription to other frames leaves no gap.
    subscribe(client, sensors_and({v1::DISPARITY}));
    publish(1);
    sensors = receive(client);
    ASSERT_TRUE(sensors);
    EXPECT_EQ(sensors->samples(0).camera_ns(), 7);
    subscribe(client, subscription({}));
    publish(1);
    status(client);
    EXPECT_FALSE(client.receive(0ms));
}

TEST_F(SensorServerTest, FramesAndSamplesBothArrive) {
    start();
    WireClient client = connect(unix_);
    subscribe(client, sensors_and({v1::DISPARITY}));
    for (int i = 0; i < 3; ++i) {
        publish(10);
        server_->publish(feed_.next());
        const auto first = client.receive();
        const auto second = client.receive();
        ASSERT_TRUE(first && second);
        EXPECT_TRUE(first->envelope.has_sensors());
        EXPECT_TRUE(second->envelope.has_frame());
    }
}

TEST_F(SensorServerTest, WhoReadsTooSlowlyMissesOldSamplesAndIsTold) {
    start();
    WireClient slow = connect(tcp_);
    WireClient quick = connect(tcp_);
    subscribe(slow, sensors_and({}));
    subscribe(quick, sensors_and({}));
    // More than the sockets between them hold.
    constexpr int batches = 400;
    constexpr std::size_t samples = 1000;
    for (int i = 0; i < batches; ++i) {
        publish(samples);
        const auto sensors = receive(quick);
        ASSERT_TRUE(sensors);
        ASSERT_EQ(sensors->skipped(), 0U);
    }
    std::uint64_t got = 0;
    std::uint64_t skipped = 0;
    while (got + skipped < batches * samples) {
        const auto sensors = receive(slow);
        ASSERT_TRUE(sensors);
        skipped += sensors->skipped();
        ASSERT_EQ(sensors->samples(0).camera_ns(), static_cast<std::int64_t>(got + skipped));
        got += static_cast<std::uint64_t>(sensors->samples_size());
        ASSERT_LE(sensors->samples_size(), static_cast<int>(daemon::SensorRing::capacity));
    }
    EXPECT_GT(skipped, 0U);
    EXPECT_EQ(got + skipped, batches * samples);
}

}  // namespace
}  // namespace disparityd::test
