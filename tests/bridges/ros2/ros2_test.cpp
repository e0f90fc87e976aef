// SPDX-License-Identifier: Apache-2.0
//
// The program beside a real daemon, and subscribers of another DDS: Fast DDS on the loopback interface.
#include <csignal>
#include <map>

#include <gmock/gmock.h>

#include "bridges/ros_messages/encode.h"
#include "bridges/ros_messages/message_definitions.h"
#include "formats/cdr_reader.h"
#include "tests/bridges/ros2/claimed_domain.h"
#include "tests/bridges/ros2/fast_subscriber.h"
#include "tests/bridges/ros2/loopback.h"
#include "tests/daemon/daemon_fixture.h"
#include "tests/proto/fake_daemon.h"

namespace disparityd::test {
namespace {

using disparity::Product;
using ros::Content;
using testing::Contains;
using testing::HasSubstr;

struct Subject {
    Content content;
    std::string topic;  ///< of DDS, with %s for the namespace

    std::string type() const { return ros::dds_type_name(ros::message_name(content)); }
};

class Ros2Test : public DaemonTest {
protected:
    void SetUp() override {
        if (!loopback_carries_datagrams()) {
            GTEST_SKIP() << "no datagram comes through the loopback interface here";
        }
    }

    /// A daemon that listens where its name says.
    std::string slow_scene(const std::string& more = "[scan]\nenabled = true\n") const {
        std::string config = only_in_memory(more);
        const std::size_t line = config.find("unix = ");
        return config.erase(line, config.find('\n', line) + 1 - line);
    }

    /// A daemon whose sockets are elsewhere: it tells no status.
    std::string only_in_memory(const std::string& more = "[scan]\nenabled = true\n") const {
        return config_text("scene:vga@20?width=320&height=176&loop=8", 160, 88, more);
    }

    std::uint32_t domain() const { return domains_.id(); }

    std::unique_ptr<DaemonProcess> start_bridge(const std::vector<std::string>& more = {},
                                                const std::string& socket = "") {
        return start_bridge_in(domain(), more, socket);
    }

    std::unique_ptr<DaemonProcess> start_bridge_in(std::uint32_t id, const std::vector<std::string>& more = {},
                                                   const std::string& socket = "") {
        std::signal(SIGINT, SIG_DFL);  // a shell's background job inherits that it is ignored
        std::vector<std::string> arguments{"--points-most", "100000", "--points-rate", "1000"};
        arguments.push_back(socket.empty() ? "--name" : "--socket");
        arguments.push_back(socket.empty() ? shared_memory_name() : socket);
        arguments.insert(arguments.end(), more.begin(), more.end());
        return std::make_unique<DaemonProcess>(
            folder_, arguments,
            DaemonProcess::Environment{{"ROS_DOMAIN_ID", std::to_string(id)}, {"ROS_LOCALHOST_ONLY", "1"}},
            DISPARITY_ROS2);
    }

    static bool gets(FastSubscriber& subscriber, const std::string& topic, std::size_t count = 3) {
        std::size_t came = 0;
        return subscriber.wait([&] {
            came += subscriber.take(topic).size();
            return came >= count;
        });
    }

    const ClaimedDomain domains_;
    const Subject image_{Content::left_grey_image, "rt/stereo/left/image_rect"};
    const Subject info_{Content::right_info, "rt/stereo/right/camera_info"};
    const Subject depth_{Content::depth, "rt/stereo/depth/image_rect"};
    const Subject points_{Content::points, "rt/stereo/points2"};
    const Subject scan_{Content::scan, "rt/stereo/scan"};
};

/// Reads all frames of a daemon beside the bridge, to encode them once more.
class Expected {
public:
    explicit Expected(const std::string& name) : reader_(name) {
        encoding_.cloud.most_points = 100000;
        encoding_.names = {.left = "stereo_left_optical_frame",
                           .camera = "stereo_link",
                           .scan = "stereo_footprint",
                           .imu = "stereo_imu_link"};
        encoding_.hidden = ros::HiddenSpace::obstacle;
    }

    void read() {
        disparity::Frame frame;
        while (reader_.read(frame, std::chrono::milliseconds(0)) == disparity::ReadResult::frame) {
            frames_[frame.realtime_ns] = frame;
        }
    }

    /// Returns whether the frame is known, and compares the message with it.
    bool check(Content content, const FastMessage& message) const {
        const auto frame = frames_.find(stamp_of(message));
        if (frame == frames_.end()) {
            return false;
        }
        std::string wanted = ros::encode(content, frame->second, encoding_).value();
        EXPECT_LT(message.bytes.size() - wanted.size(), 4U);
        wanted.resize(message.bytes.size());
        EXPECT_TRUE(message.bytes == wanted) << "content " << static_cast<int>(content);
        return true;
    }

private:
    disparity::SharedMemoryReader reader_;
    ros::Encoding encoding_;
    std::map<std::int64_t, disparity::Frame> frames_;
};

TEST_F(Ros2Test, MessagesComeAsTheyWereEncoded) {
    const auto daemon = start_ready(slow_scene());
    const auto bridge = start_bridge();
    FastSubscriber subscriber(domain());
    FastSubscriber careless(domain());
    const std::vector<Subject> subjects{image_, info_, depth_, points_, scan_};
    for (const Subject& subject : subjects) {
        subscriber.subscribe(subject.topic, subject.type());
        careless.subscribe(subject.topic, subject.type(), {.reliable = false});
    }
    Expected expected(shared_memory_name());
    for (FastSubscriber* one : {&subscriber, &careless}) {
        for (const Subject& subject : subjects) {
            int checked = 0;
            EXPECT_TRUE(one->wait([&] {
                expected.read();
                for (const FastMessage& message : one->take(subject.topic)) {
                    checked += expected.check(subject.content, message) ? 1 : 0;
                }
                return checked >= 3;
            })) << subject.topic
                << ": " << checked << bridge->log();
            EXPECT_EQ(one->user_data(subject.topic),
                      "typehash=" + std::string(ros::type_hash(ros::message_name(subject.content))) + ";");
        }
    }
    bridge->send_signal(SIGINT);
    EXPECT_EQ(bridge->wait_for_exit(), 0) << bridge->log();
}

TEST_F(Ros2Test, SharedMemoryWithoutASocketIsEnough) {
    const auto daemon = start_ready(only_in_memory());
    const auto bridge = start_bridge();
    FastSubscriber subscriber(domain());
    for (const Subject& subject : {depth_, points_}) {
        subscriber.subscribe(subject.topic, subject.type());
        EXPECT_TRUE(gets(subscriber, subject.topic)) << bridge->log();
    }
    EXPECT_TRUE(bridge->wait_for_log("the daemon tells no status: ")) << bridge->log();
}

TEST_F(Ros2Test, EverySideMayStartFirstAndAnew) {
    auto subscriber = std::make_unique<FastSubscriber>(domain());
    subscriber->subscribe(image_.topic, image_.type());
    auto bridge = start_bridge();
    EXPECT_TRUE(subscriber->wait([&] { return subscriber->writers(image_.topic) == 1; })) << bridge->log();
    auto daemon = start_ready(slow_scene());
    EXPECT_TRUE(gets(*subscriber, image_.topic)) << "the daemon came last" << bridge->log();

    daemon->send_signal(SIGKILL);
    EXPECT_EQ(daemon->wait_for_exit(), 128 + SIGKILL);
    daemon = start_ready(slow_scene());
    EXPECT_TRUE(gets(*subscriber, image_.topic, 20)) << "the daemon came anew" << bridge->log();

    bridge->send_signal(SIGTERM);
    EXPECT_EQ(bridge->wait_for_exit(), 0);
    EXPECT_TRUE(subscriber->wait([&] { return subscriber->writers(image_.topic) == 0; })) << "it says that it goes";
    subscriber->take(image_.topic);
    bridge = start_bridge();
    EXPECT_TRUE(gets(*subscriber, image_.topic)) << "the bridge came anew" << bridge->log();

    subscriber = std::make_unique<FastSubscriber>(domain());
    subscriber->subscribe(image_.topic, image_.type());
    EXPECT_TRUE(gets(*subscriber, image_.topic)) << "the subscriber came anew" << bridge->log();
}

TEST_F(Ros2Test, DomainsAreApart) {
    const auto daemon = start_ready(slow_scene());
    const auto here = start_bridge({"--camera-name", "here"});
    const auto there = start_bridge_in(domains_.other(), {"--camera-name", "there"});
    FastSubscriber subscriber(domain());
    FastSubscriber other(domains_.other());
    for (FastSubscriber* one : {&subscriber, &other}) {
        one->subscribe("rt/here/scan", scan_.type());
        one->subscribe("rt/there/scan", scan_.type());
    }
    EXPECT_TRUE(gets(subscriber, "rt/here/scan", 5));
    EXPECT_TRUE(gets(other, "rt/there/scan", 5));
    EXPECT_EQ(subscriber.user_data("rt/there/scan"), "");
    EXPECT_EQ(subscriber.writers("rt/there/scan"), 0);
    EXPECT_EQ(other.user_data("rt/here/scan"), "");
    EXPECT_EQ(other.writers("rt/here/scan"), 0);
}

/// A daemon that matches on demand tells whether somebody wants frames.
TEST_F(Ros2Test, NothingIsReadWithoutSubscribers) {
    std::string config = slow_scene();
    const std::string before = "[pipeline]\n";
    config.insert(config.find(before) + before.size(), "on_demand = true\n");
    const auto daemon = start_ready(config);
    const auto bridge = start_bridge();
    EXPECT_TRUE(bridge->wait_for_log("the daemon answers")) << bridge->log();
    disparity::Client client(shared_memory_name(), {.products = {}});
    const auto status = [&client] {
        v1::Status now;
        EXPECT_TRUE(now.ParseFromString(client.status()));
        return now;
    };
    FastSubscriber subscriber(domain());
    const auto wait_for_unwanted = [&] {
        const std::uint64_t first = status().unwanted();
        return subscriber.wait([&] { return status().state() == "idle" && status().unwanted() >= first + 5; });
    };
    EXPECT_TRUE(wait_for_unwanted()) << "the bridge alone wants none";
    subscriber.subscribe(image_.topic, image_.type());
    EXPECT_TRUE(gets(subscriber, image_.topic)) << bridge->log();
    EXPECT_EQ(status().state(), "running");
    subscriber.unsubscribe(image_.topic);
    EXPECT_TRUE(wait_for_unwanted()) << "nobody subscribes any more";
}

TEST_F(Ros2Test, TheGraphHasTheNode) {
    const auto bridge = start_bridge({"--camera-name", "front", "--node-name", "eyes"});
    FastSubscriber subscriber(domain());
    subscriber.subscribe("ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_",
                         {.reliable = true, .transient_local = true, .depth = 1});
    std::vector<FastMessage> messages;
    ASSERT_TRUE(subscriber.wait([&] {
        messages = subscriber.take("ros_discovery_info");
        return !messages.empty();
    })) << bridge->log();
    const std::string& bytes = messages.back().bytes;
    formats::CdrReader cdr({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    const std::vector<std::uint8_t> participant = cdr.get<std::uint8_t>(16);
    EXPECT_EQ(cdr.get<std::uint32_t>(), 1U);
    EXPECT_EQ(cdr.text(), "/front");
    EXPECT_EQ(cdr.text(), "eyes");
    EXPECT_EQ(cdr.get<std::uint32_t>(), 0U) << "readers";
    const auto writers = cdr.get<std::uint32_t>();
    EXPECT_GT(writers, 20U);
    for (std::uint32_t i = 0; i < writers; ++i) {
        std::vector<std::uint8_t> writer = cdr.get<std::uint8_t>(16);
        EXPECT_NE(writer, participant);
        std::copy(participant.begin() + 12, participant.end(), writer.begin() + 12);
        EXPECT_EQ(writer, participant) << "they have its prefix";
    }
    EXPECT_THAT(subscriber.participants(), Contains("enclave=/;"));
}

TEST_F(Ros2Test, StaticTransformsAreThereForThoseThatComeLater) {
    const auto daemon = start_ready(slow_scene());
    const auto bridge = start_bridge({"--parent-frame", "base_link", "--height-m", "0.5"});
    EXPECT_TRUE(bridge->wait_for_log("the daemon answers"));
    for (int i = 0; i < 2; ++i) {
        FastSubscriber subscriber(domain());
        subscriber.subscribe("rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_",
                             {.reliable = true, .transient_local = true});
        std::vector<FastMessage> messages;
        ASSERT_TRUE(subscriber.wait([&] {
            messages = subscriber.take("rt/tf_static");
            return !messages.empty();
        })) << bridge->log();
        const std::string& bytes = messages.back().bytes;
        formats::CdrReader cdr({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
        EXPECT_EQ(cdr.get<std::uint32_t>(), 5U)
            << "base_link to the camera and the ground, the camera to both eyes, the left one to itself unrectified";
        EXPECT_THAT(bytes, HasSubstr("base_link"));
        EXPECT_THAT(bytes, HasSubstr("stereo_right_optical_frame"));
        EXPECT_THAT(bytes, HasSubstr("stereo_left_raw_optical_frame"));
    }
}

TEST_F(Ros2Test, ASubscriberThatStopsHoldsNobody) {
    const auto daemon = start_ready(slow_scene());
    const auto bridge = start_bridge();
    const auto sleeper = std::make_unique<DaemonProcess>(
        folder_, std::vector<std::string>{std::to_string(domain()), "600", depth_.topic, depth_.type()},
        DaemonProcess::Environment{}, ROS2_LISTENER);
    EXPECT_TRUE(sleeper->wait_for_line([&](const std::string& line) { return line == "first " + depth_.topic; }))
        << bridge->log();
    sleeper->send_signal(SIGSTOP);
    FastSubscriber subscriber(domain());
    subscriber.subscribe(depth_.topic, depth_.type());
    EXPECT_TRUE(gets(subscriber, depth_.topic, 60)) << bridge->log();
    EXPECT_THAT(bridge->log(), testing::Not(HasSubstr("in time"))) << "no write waited";
    sleeper->send_signal(SIGKILL);
}

/// A daemon that the test plays has a camera with sensors, and sends a sample to who asks for it.
TEST_F(Ros2Test, SamplesOfTheSensorsComeAsImu) {
    v1::Envelope status;
    status.mutable_status()->set_state("running");
    status.mutable_status()->mutable_geometry()->set_width(160);
    status.mutable_status()->mutable_sensors()->set_state("streaming");
    v1::Envelope samples;
    v1::SensorSample& sample = *samples.mutable_sensors()->add_samples();
    sample.set_realtime_ns(1'700'000'000'000'000'007);
    sample.mutable_inertial()->mutable_acceleration()->set_z(9.75F);
    FakeDaemon daemon([&](ServerEnd& client) {
        client.greet();
        v1::Envelope asked;
        while (client.receive(asked)) {
            if (asked.has_status_request()) {
                client.send(status);
            } else if (asked.has_subscribe() && asked.subscribe().sensors()) {
                client.send(samples);
            }
        }
    });
    const auto bridge = start_bridge({}, daemon.unix_address());
    FastSubscriber subscriber(domain());
    subscriber.subscribe("rt/stereo/imu/data_raw", "sensor_msgs::msg::dds_::Imu_");
    std::vector<FastMessage> messages;
    ASSERT_TRUE(subscriber.wait([&] {
        messages = subscriber.take("rt/stereo/imu/data_raw");
        return !messages.empty();
    })) << bridge->log();
    disparity::SensorSample wanted;
    wanted.realtime_ns = 1'700'000'000'000'000'007;
    wanted.inertial = disparity::Inertial{{}, {0, 0, 9.75F}, 0};
    EXPECT_EQ(messages.front().bytes, ros::encode(Content::imu, wanted, {.imu = "stereo_imu_link"}).value());
    bridge->send_signal(SIGTERM);
    EXPECT_EQ(bridge->wait_for_exit(), 0) << bridge->log();
}

TEST_F(Ros2Test, WhatIsMissingIsSaid) {
    const auto daemon = start_ready(slow_scene(""));
    const auto bridge = start_bridge();
    FastSubscriber subscriber(domain());
    subscriber.subscribe(scan_.topic, scan_.type());
    EXPECT_TRUE(
        bridge->wait_for_log("/stereo/scan is subscribed to, and nothing comes: the daemon does not serve the "
                             "product scan: set scan.enabled = true"))
        << bridge->log();
}

TEST_F(Ros2Test, AWrongVariableIsOneLine) {
    const auto bridge = start_bridge_in(233);
    EXPECT_EQ(bridge->wait_for_exit(), 2);
    EXPECT_THAT(bridge->log(), HasSubstr("disparity-ros2: error: ROS_DOMAIN_ID: found \"233\", allowed: 0 .. 232; see "
                                         "disparity-ros2 --help"));
}

}  // namespace
}  // namespace disparityd::test
