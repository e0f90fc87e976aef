// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/node.h"

#include <gtest/gtest.h>

#include "bridges/ros2/cdr_topic.h"

namespace disparityd::ros2 {
namespace {

using std::chrono::milliseconds;

TEST(Ros2Node, ASubscriberWakesItOnce) {
    constexpr std::uint32_t nobodys_domain = 171;
    Node node({}, {.id = nobodys_domain, .range = DiscoveryRange::off});
    const Publisher& publisher = node.advertise("/tf_static", "tf2_msgs/TFMessage", {});
    EXPECT_FALSE(node.wait(milliseconds(0)));
    const dds_entity_t participant = dds_create_participant(nobodys_domain, nullptr, nullptr);
    const dds_entity_t topic = create_cdr_topic(participant, "rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_");
    ASSERT_GE(dds_create_reader(participant, topic, nullptr, nullptr), 0);
    EXPECT_TRUE(node.wait(milliseconds(60'000)));
    EXPECT_FALSE(node.wait(milliseconds(0))) << "though nobody has asked for its readers";
    EXPECT_EQ(publisher.readers(), 1U);
    EXPECT_EQ(dds_delete(participant), DDS_RETCODE_OK);
    EXPECT_TRUE(node.wait(milliseconds(60'000))) << "it has gone";
    EXPECT_FALSE(node.wait(milliseconds(0)));
}

}  // namespace
}  // namespace disparityd::ros2
