// SPDX-License-Identifier: Apache-2.0
#include "capture/sensors/sensor_stream.h"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/capture/camera/fake_camera.h"
#include "tests/capture/sensors/fake_sensors.h"

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class SensorStreamTest : public ::testing::Test {
protected:
    void run(std::chrono::milliseconds time) {
        for (const auto end = system_.now() + time; system_.now() < end;) {
            stream_.step(waker_, end);
        }
    }

    void follow() { stream_.follow(camera_); }
    const SensorFacts& facts() const { return stream_.facts(); }

    test::FakeSensorSystem system_;
    UsbCamera camera_ = test::zed2().usb;
    base::Waker waker_;
    std::vector<SensorSample> samples_;
    std::vector<std::string> reports_;
    SensorStream stream_{system_, [this](const SensorSample& sample) { samples_.push_back(sample); },
                         [this](const std::string& line, bool) { reports_.push_back(line); }};
};

TEST_F(SensorStreamTest, NobodysSensorsAreNotOpened) {
    run(2s);
    EXPECT_EQ(system_.opened(), 0);
}

TEST_F(SensorStreamTest, GivesEverySampleItsTime) {
    follow();
    run(20s);
    // 400 a second, the first at once, but for those that the clock settles with; for longer than without pings.
    EXPECT_EQ(samples_.size(), 8001U - SensorClock::settling_samples);
    EXPECT_EQ(facts().samples, samples_.size());
    EXPECT_EQ(facts().state, SensorState::streaming);
    EXPECT_EQ(facts().node, "/dev/hidraw3");
    EXPECT_THAT(reports_, ElementsAre(HasSubstr("send")));
    for (std::size_t i = 1; i < samples_.size(); ++i) {
        ASSERT_EQ(samples_[i].camera_ns - samples_[i - 1].camera_ns, 2'500'000);
        ASSERT_LT(std::abs(samples_[i].monotonic_ns - samples_[i - 1].monotonic_ns - 2'500'000), 1000);
        ASSERT_EQ(samples_[i].realtime_ns - samples_[i].monotonic_ns, test::FakeSensorSystem::offset);
    }
    EXPECT_FLOAT_EQ(samples_.back().acceleration.z, 9.80665F);
    EXPECT_LT(system_.waits(), 8200) << "no busy wait";
}

TEST_F(SensorStreamTest, SilentSensorsAreOpenedAnew) {
    follow();
    run(1s);
    system_.frozen = true;
    run(1s);
    EXPECT_EQ(facts().state, SensorState::streaming) << "some patience";
    run(2s);
    EXPECT_EQ(facts().state, SensorState::silent);
    EXPECT_THAT(facts().detail, HasSubstr("send nothing"));
    run(20s);
    EXPECT_EQ(reports_.size(), 2U) << "said once";
    EXPECT_GT(system_.opened(), 5);
    EXPECT_LE(system_.open_devices(), 1);
    system_.frozen = false;
    run(5s);
    EXPECT_EQ(facts().state, SensorState::streaming);
    EXPECT_THAT(facts().detail, IsEmpty());
}

TEST_F(SensorStreamTest, UnpluggedSensorsComeBack) {
    follow();
    run(1s);
    system_.unplug();
    run(500ms);
    EXPECT_EQ(facts().state, SensorState::absent);
    EXPECT_EQ(system_.open_devices(), 0);
    const std::size_t before = samples_.size();
    system_.plug();
    run(1s);
    EXPECT_EQ(facts().state, SensorState::streaming);
    ASSERT_GT(samples_.size(), before);
    EXPECT_GT(samples_[before].monotonic_ns, samples_[before - 1].monotonic_ns);
}

TEST_F(SensorStreamTest, MissingOnesAreTroubleOnlyAfterAWhile) {
    system_.unplug();
    follow();
    run(2s);
    EXPECT_EQ(facts().state, SensorState::starting);
    EXPECT_THAT(reports_, IsEmpty());
    run(2s);
    EXPECT_EQ(facts().state, SensorState::absent);
    EXPECT_THAT(reports_, ElementsAre(HasSubstr("another cable")));
}

TEST_F(SensorStreamTest, SaysWhatKeepsThemFromBeingOpened) {
    system_.open_error = EACCES;
    follow();
    run(4s);
    EXPECT_EQ(facts().state, SensorState::no_permission);
    EXPECT_THAT(facts().detail, HasSubstr("/dev/hidraw3: Permission denied: install disparityd's udev rule"));
    system_.open_error = EIO;
    run(1s);
    EXPECT_EQ(facts().state, SensorState::failed);
    system_.open_error = 0;
    system_.send_error = EPIPE;
    run(1s);
    EXPECT_THAT(facts().detail, HasSubstr("refuse to start: Broken pipe"));
    EXPECT_EQ(system_.open_devices(), 0);
    EXPECT_LT(system_.waits(), 50) << "no busy wait";
    system_.send_error = 0;
    run(1s);
    EXPECT_EQ(facts().state, SensorState::streaming);
}

TEST_F(SensorStreamTest, OtherReportsAreCountedAndLeftOut) {
    follow();
    run(1s);
    const std::size_t before = samples_.size();
    system_.next_report = {1, 2, 3};
    run(1s);
    EXPECT_EQ(facts().refused, 1U);
    EXPECT_EQ(samples_.size(), before + 399);
}

TEST_F(SensorStreamTest, LetsGoOfTheDeviceWhenNobodyIsFollowed) {
    follow();
    run(1s);
    stream_.follow(std::nullopt);
    EXPECT_EQ(system_.open_devices(), 0);
    const std::size_t before = samples_.size();
    run(1s);
    EXPECT_EQ(samples_.size(), before);
}

}  // namespace
}  // namespace disparityd::capture
