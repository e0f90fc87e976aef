// SPDX-License-Identifier: Apache-2.0
#include "capture/sensors/sensor_reader.h"

#include <array>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "capture/camera/camera_source.h"
#include "tests/capture/camera/fake_camera.h"
#include "tests/capture/sensors/sensor_bytes.h"

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;

/// Sensors at the other end of a socket, on the true clock.
class SocketSensors final : public SensorSystem {
public:
    SocketSensors() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends_.data()), 0); }
    ~SocketSensors() override {
        ::close(ends_[0]);
        ::close(ends_[1]);
    }
    SocketSensors(const SocketSensors&) = delete;
    SocketSensors& operator=(const SocketSensors&) = delete;

    /// Reports that arrive without a pause, as after a time in which nobody read; the receiver takes each.
    void send_reports(int count) {
        for (int i = 0; i < count; ++i) {
            test::SensorBytes bytes;
            bytes.ticks = ticks_ += 64;
            const auto report = bytes.report();
            while (::send(ends_[1], report.data(), report.size(), 0) < 0) {
                std::this_thread::yield();
            }
        }
    }

    std::vector<SensorDevice> devices() override {
        return {{"/dev/hidraw0", "1-1.2", zed_vendor, 0xf781, 0x0308, "12345"}};
    }
    int open(const std::string& /*node*/) override { return ::dup(ends_[0]); }
    void close(int device) override { ::close(device); }
    int read(int device, std::span<std::uint8_t> report) override {
        const ssize_t bytes = ::read(device, report.data(), report.size());
        return bytes < 0 ? -errno : static_cast<int>(bytes);
    }
    int send(int /*device*/, std::span<const std::uint8_t> /*report*/) override { return 0; }
    base::Wakening wait(int device, base::Waker& waker, std::chrono::steady_clock::time_point deadline) override {
        return linux_video_system().wait(device, waker, deadline);
    }
    std::chrono::steady_clock::time_point now() override { return std::chrono::steady_clock::now(); }
    std::int64_t realtime_ns() override { return 0; }

private:
    std::array<int, 2> ends_{-1, -1};
    std::uint64_t ticks_ = 0;
};

bool eventually(const std::function<bool()>& condition) {
    for (const auto end = std::chrono::steady_clock::now() + 60s; std::chrono::steady_clock::now() < end;) {
        if (condition()) {
            return true;
        }
        std::this_thread::sleep_for(1ms);
    }
    return false;
}

class SensorReaderTest : public ::testing::Test {
protected:
    bool wait_for(std::uint64_t samples) {
        return eventually([&] { return reader_.facts() && reader_.facts()->samples >= samples; });
    }

    static constexpr int settling = SensorClock::settling_samples;
    SocketSensors sensors_;
    SensorReader reader_{sensors_, [](const std::string&, bool) {}};
    UsbCamera camera_ = test::zed2().usb;
};

TEST_F(SensorReaderTest, KeepsSamplesUntilTheyAreTaken) {
    EXPECT_FALSE(reader_.facts());
    reader_.follow(camera_);
    EXPECT_TRUE(reader_.facts());
    sensors_.send_reports(settling + 10);
    ASSERT_TRUE(wait_for(10));
    std::array<SensorSample, 8> samples{};
    EXPECT_EQ(reader_.take(samples), 8U);
    EXPECT_EQ(samples[0].camera_ns, (settling + 1) * 2'500'000LL);
    EXPECT_EQ(samples[7].camera_ns, (settling + 8) * 2'500'000LL);
    EXPECT_EQ(reader_.take(samples), 2U);
    EXPECT_EQ(samples[1].camera_ns, (settling + 10) * 2'500'000LL);
    EXPECT_EQ(reader_.take(samples), 0U);
    reader_.follow(std::nullopt);
    EXPECT_FALSE(reader_.facts());
}

TEST_F(SensorReaderTest, OldSamplesMakeRoomAndAreCounted) {
    reader_.follow(camera_);
    constexpr int too_many = 500;
    constexpr int sent = static_cast<int>(SensorReader::most_waiting) + too_many;
    sensors_.send_reports(settling + sent);
    ASSERT_TRUE(wait_for(sent));
    std::vector<SensorSample> samples(4096);
    ASSERT_EQ(reader_.take(samples), SensorReader::most_waiting);
    EXPECT_EQ(samples[0].lost_before, too_many);
    EXPECT_EQ(samples[0].camera_ns, (settling + too_many + 1) * 2'500'000LL);
    EXPECT_EQ(samples[1].lost_before, 0U);
    EXPECT_EQ(reader_.facts()->lost, too_many);
}

TEST_F(SensorReaderTest, ACameraWithoutSensorsHasNone) {
    camera_.product = 0xf582;
    reader_.follow(camera_);
    EXPECT_FALSE(reader_.facts());
}

TEST(CameraWithSensors, FramesBringWhatWasMeasuredBetweenThem) {
    test::FakeVideoSystem video;
    SocketSensors sensors;
    video.plug(test::zed2());
    SourceOptions options;
    options.uri = "v4l2:64x16@30";
    options.wait_for_camera = true;
    const auto source = open_camera_on(video, options, &sensors);
    const auto next = [&] {
        RawFrame frame;
        while (source->next(frame, video.now() + 1s) != FrameSource::Next::frame) {
        }
        source->give_back(frame);
        return frame;
    };
    EXPECT_EQ(next().sensors.size(), 0U);
    sensors.send_reports(SensorClock::settling_samples + 7);
    ASSERT_TRUE(eventually([&] { return source->condition().sensors && source->condition().sensors->samples == 7; }));
    const RawFrame frame = next();
    ASSERT_EQ(frame.sensors.size(), 7U);
    EXPECT_EQ(frame.sensors[6].camera_ns - frame.sensors[0].camera_ns, 6 * 2'500'000);
    EXPECT_EQ(next().sensors.size(), 0U);
    video.unplug("/dev/video0");
    RawFrame none;
    EXPECT_TRUE(eventually([&] {
        source->next(none, video.now() + 100ms);
        return !source->condition().sensors;
    })) << "they go with their camera";
}

TEST(CameraWithSensors, TheyCanBeSwitchedOff) {
    test::FakeVideoSystem video;
    SocketSensors sensors;
    video.plug(test::zed2());
    SourceOptions options;
    options.uri = "v4l2:64x16@30";
    options.sensors = false;
    const auto source = open_camera_on(video, options, &sensors);
    EXPECT_FALSE(source->condition().sensors);
}

}  // namespace
}  // namespace disparityd::capture
