// SPDX-License-Identifier: Apache-2.0
//
// Messages that the node publishes are read in the same process by types that idlc has made of the published
// definitions.
#include <cmath>
#include <cstring>
#include <memory>

#include <gmock/gmock.h>
#include <messages.h>

#include "bridges/ros2/node.h"
#include "bridges/ros_messages/diagnostic_message.h"
#include "bridges/ros_messages/encode.h"
#include "tests/bridges/ros_messages/message_frames.h"

namespace disparityd::ros2 {
namespace {

using ros::Content;

constexpr std::int32_t stamp_seconds = 1'700'000'000;
constexpr std::uint32_t nanoseconds = 123'456'789;

class Ros2IdlTypes : public ::testing::Test {
protected:
    static Domain nobodys_domain() { return {.id = 171, .range = DiscoveryRange::off}; }

    ~Ros2IdlTypes() override { dds_delete(participant_); }

    /// Publishes the message and returns it as a reader of its type gets it.
    template <typename Message>
    std::shared_ptr<const Message> through_dds(Content content, const std::string& bytes,
                                               const dds_topic_descriptor_t& descriptor) {
        const std::string topic = "/topic_" + std::to_string(static_cast<int>(content));
        const Publisher& publisher = node_.advertise(topic, ros::message_name(content), {});
        const dds_entity_t made = dds_create_topic(participant_, &descriptor, ("rt" + topic).c_str(), nullptr, nullptr);
        EXPECT_GE(made, 0) << dds_strretcode(made);
        std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)> qos(dds_create_qos(), dds_delete_qos);
        dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
        const dds_entity_t reader = dds_create_reader(participant_, made, qos.get(), nullptr);
        EXPECT_GE(reader, 0) << dds_strretcode(reader);
        EXPECT_EQ(publisher.readers(), 1U) << "types and quality match";
        EXPECT_TRUE(publisher.publish(bytes));
        void* sample = nullptr;
        dds_sample_info_t info{};
        EXPECT_EQ(dds_take(reader, &sample, &info, 1, 1), 1) << "the reader finds no mistake in it";
        return {static_cast<const Message*>(sample), [reader](const Message* message) {
                    void* lent = const_cast<Message*>(message);
                    dds_return_loan(reader, &lent, 1);
                }};
    }

    template <typename Message>
    std::shared_ptr<const Message> of_frame(Content content, const disparity::Frame& frame,
                                            const dds_topic_descriptor_t& descriptor) {
        return through_dds<Message>(content, ros::encode(content, frame, {}).value(), descriptor);
    }

    static void expect_header(const std_msgs_msg_dds__Header_& header, const std::string& frame) {
        EXPECT_EQ(header.stamp.sec, stamp_seconds);
        EXPECT_EQ(header.stamp.nanosec, nanoseconds);
        EXPECT_EQ(header.frame_id, frame);
    }

    Node node_{{}, nobodys_domain()};
    dds_entity_t participant_ = dds_create_participant(nobodys_domain().id, nullptr, nullptr);
};

TEST_F(Ros2IdlTypes, Image) {
    const disparity::Frame frame = test::grey_frame();
    const auto message =
        of_frame<sensor_msgs_msg_dds__Image_>(Content::depth_mm, frame, sensor_msgs_msg_dds__Image__desc);
    ASSERT_TRUE(message);
    expect_header(message->header, "left_camera");
    EXPECT_EQ(message->width, test::frame_width);
    EXPECT_EQ(message->height, test::frame_height);
    EXPECT_STREQ(message->encoding, "16UC1");
    EXPECT_EQ(message->is_bigendian, 0);
    EXPECT_EQ(message->step, 2 * test::frame_width);
    const std::vector<std::uint8_t>& plane = frame.plane(disparity::Product::depth)->bytes;
    ASSERT_EQ(message->data._length, plane.size());
    EXPECT_EQ(std::memcmp(message->data._buffer, plane.data(), plane.size()), 0);
}

TEST_F(Ros2IdlTypes, CompressedImage) {
    const auto message = of_frame<sensor_msgs_msg_dds__CompressedImage_>(Content::left_jpeg, test::colour_frame(),
                                                                         sensor_msgs_msg_dds__CompressedImage__desc);
    ASSERT_TRUE(message);
    expect_header(message->header, "left_camera");
    EXPECT_STREQ(message->format, "jpeg");
    EXPECT_EQ(message->data._buffer[0], 0xff);
}

TEST_F(Ros2IdlTypes, CameraInfo) {
    const auto message = of_frame<sensor_msgs_msg_dds__CameraInfo_>(Content::right_info, test::grey_frame(),
                                                                    sensor_msgs_msg_dds__CameraInfo__desc);
    ASSERT_TRUE(message);
    expect_header(message->header, "left_camera");
    EXPECT_STREQ(message->distortion_model, "plumb_bob");
    EXPECT_EQ(message->d._length, 5U);
    EXPECT_EQ(message->k[2], 3.75);
    EXPECT_EQ(message->r[8], 1);
    EXPECT_EQ(message->p[3], -12);
    EXPECT_EQ(message->p[10], 1);
    EXPECT_EQ(message->roi.height, 0U);
    EXPECT_FALSE(message->roi.do_rectify);
}

TEST_F(Ros2IdlTypes, PointCloud2) {
    const auto message = of_frame<sensor_msgs_msg_dds__PointCloud2_>(Content::points, test::colour_frame(),
                                                                     sensor_msgs_msg_dds__PointCloud2__desc);
    ASSERT_TRUE(message);
    ASSERT_EQ(message->fields._length, 4U);
    EXPECT_STREQ(message->fields._buffer[3].name, "rgb");
    EXPECT_EQ(message->fields._buffer[3].offset, 12U);
    EXPECT_EQ(message->fields._buffer[3].datatype, 7);
    EXPECT_EQ(message->row_step, 16 * test::frame_width);
    EXPECT_EQ(message->data._length, message->row_step * test::frame_height);
    EXPECT_FALSE(message->is_dense);
}

TEST_F(Ros2IdlTypes, LaserScan) {
    const auto message = of_frame<sensor_msgs_msg_dds__LaserScan_>(Content::scan, test::grey_frame(),
                                                                   sensor_msgs_msg_dds__LaserScan__desc);
    ASSERT_TRUE(message);
    expect_header(message->header, "camera_footprint");
    EXPECT_EQ(message->range_max, 10);
    ASSERT_EQ(message->ranges._length, 4U);
    EXPECT_EQ(message->ranges._buffer[0], 2.5F);
    EXPECT_TRUE(std::isinf(message->ranges._buffer[1]));
    EXPECT_TRUE(std::isnan(message->ranges._buffer[2]));
    EXPECT_EQ(message->intensities._buffer[0], 200);
}

TEST_F(Ros2IdlTypes, DisparityImage) {
    const auto message = of_frame<stereo_msgs_msg_dds__DisparityImage_>(Content::disparity, test::grey_frame(),
                                                                        stereo_msgs_msg_dds__DisparityImage__desc);
    ASSERT_TRUE(message);
    EXPECT_STREQ(message->image.encoding, "32FC1");
    EXPECT_EQ(message->f, 100);
    EXPECT_EQ(message->t, 0.12F);
    EXPECT_EQ(message->valid_window.width, test::frame_width);
    EXPECT_EQ(message->max_disparity, 63.25F);
    EXPECT_EQ(message->delta_d, 0.0625F);
}

TEST_F(Ros2IdlTypes, Transforms) {
    const auto message = of_frame<tf2_msgs_msg_dds__TFMessage_>(Content::transforms, test::grey_frame(),
                                                                tf2_msgs_msg_dds__TFMessage__desc);
    ASSERT_TRUE(message);
    ASSERT_EQ(message->transforms._length, 1U);
    EXPECT_STREQ(message->transforms._buffer[0].child_frame_id, "left_camera");
    EXPECT_EQ(message->transforms._buffer[0].transform.rotation.y, 0.5);
}

TEST_F(Ros2IdlTypes, ClockAndSensors) {
    const auto clock =
        of_frame<rosgraph_msgs_msg_dds__Clock_>(Content::clock, test::grey_frame(), rosgraph_msgs_msg_dds__Clock__desc);
    ASSERT_TRUE(clock);
    EXPECT_EQ(clock->clock.nanosec, nanoseconds);
    const disparity::SensorSample sample = test::sensor_batch().samples.front();
    const auto imu = through_dds<sensor_msgs_msg_dds__Imu_>(Content::imu, ros::encode(Content::imu, sample, {}).value(),
                                                            sensor_msgs_msg_dds__Imu__desc);
    ASSERT_TRUE(imu);
    EXPECT_EQ(imu->orientation_covariance[0], -1);
    EXPECT_EQ(imu->angular_velocity.y, -0.25);
    EXPECT_EQ(imu->linear_acceleration.z, 1.5);
    const auto temperature = through_dds<sensor_msgs_msg_dds__Temperature_>(
        Content::left_temperature, ros::encode(Content::left_temperature, sample, {}).value(),
        sensor_msgs_msg_dds__Temperature__desc);
    ASSERT_TRUE(temperature);
    EXPECT_EQ(temperature->temperature, 33.5);
}

TEST_F(Ros2IdlTypes, Diagnostics) {
    const auto message = through_dds<diagnostic_msgs_msg_dds__DiagnosticArray_>(
        Content::diagnostics, ros::diagnostic_message(test::daemon_status(), "disparityd: front", 5'000'000'000),
        diagnostic_msgs_msg_dds__DiagnosticArray__desc);
    ASSERT_TRUE(message);
    ASSERT_EQ(message->status._length, 1U);
    const diagnostic_msgs_msg_dds__DiagnosticStatus_& status = message->status._buffer[0];
    EXPECT_EQ(status.level, 1);
    EXPECT_STREQ(status.name, "disparityd: front");
    ASSERT_GT(status.values._length, 1U);
    EXPECT_STREQ(status.values._buffer[1].value, "scene:vga@15");
}

}  // namespace
}  // namespace disparityd::ros2
