// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/domain.h"

#include <map>
#include <stdexcept>

#include <gmock/gmock.h>

namespace disparityd::ros2 {
namespace {

using testing::HasSubstr;
using testing::Not;

Domain domain_with(const std::map<std::string, std::string>& variables) {
    return domain_of([&](const std::string& name) {
        const auto found = variables.find(name);
        return found == variables.end() ? std::string() : found->second;
    });
}

std::string configuration_with(const std::map<std::string, std::string>& variables) {
    return cyclone_configuration(domain_with(variables));
}

TEST(Ros2Domain, WithoutVariablesItIsDomain0ByMulticast) {
    const Domain domain = domain_with({});
    EXPECT_EQ(domain.id, 0U);
    EXPECT_EQ(domain.range, DiscoveryRange::subnet);
    const std::string xml = cyclone_configuration(domain);
    EXPECT_THAT(xml, Not(HasSubstr("AllowMulticast")));
    EXPECT_THAT(xml, Not(HasSubstr("Peer")));
    EXPECT_THAT(xml, Not(HasSubstr("Interface")));
}

TEST(Ros2Domain, LocalhostIsTheVariablesOfOldAndNew) {
    const std::string range = configuration_with({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}});
    EXPECT_THAT(range, HasSubstr("<AllowMulticast>false</AllowMulticast>"));
    EXPECT_THAT(range, HasSubstr("<Peer address=\"127.0.0.1\"/>"));
    EXPECT_THAT(range, Not(HasSubstr("Interface")));
    const std::string old = configuration_with({{"ROS_LOCALHOST_ONLY", "1"}});
    EXPECT_THAT(old, HasSubstr("<NetworkInterface address=\"127.0.0.1\"/>"));
    EXPECT_EQ(domain_with({{"ROS_LOCALHOST_ONLY", "0"}}).range, DiscoveryRange::subnet);
}

TEST(Ros2Domain, OffHearsNobody) {
    const std::string xml =
        configuration_with({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}, {"ROS_STATIC_PEERS", "robot"}});
    EXPECT_THAT(xml, HasSubstr("<Tag>ros_discovery_off_"));
    EXPECT_THAT(xml, Not(HasSubstr("Peer ")));
}

TEST(Ros2Domain, PeersAreAsked) {
    const Domain domain = domain_with({{"ROS_STATIC_PEERS", "192.168.1.2;robot;"}});
    EXPECT_EQ(domain.peers, (std::vector<std::string>{"192.168.1.2", "robot"}));
    EXPECT_THAT(cyclone_configuration(domain), HasSubstr("<Peer address=\"192.168.1.2\"/><Peer address=\"robot\"/>"));
}

TEST(Ros2Domain, TheUsersConfigurationComesLast) {
    const std::string xml = configuration_with({{"CYCLONEDDS_URI", "file:///c.xml"}});
    EXPECT_TRUE(xml.ends_with("</CycloneDDS>,file:///c.xml"));
    EXPECT_THAT(configuration_with({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT"}}), Not(HasSubstr("Discovery")));
}

std::string refusal(const std::map<std::string, std::string>& variables) {
    try {
        domain_with(variables);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return {};
}

TEST(Ros2Domain, WhatRosDoesNotKnowIsRefused) {
    EXPECT_EQ(refusal({{"ROS_DOMAIN_ID", "233"}}), "ROS_DOMAIN_ID: found \"233\", allowed: 0 .. 232");
    EXPECT_EQ(refusal({{"ROS_DOMAIN_ID", "232"}}), "");
    for (const char* id : {"-1", "1x", " 1", "99999999999"}) {
        EXPECT_THAT(refusal({{"ROS_DOMAIN_ID", id}}), HasSubstr("allowed: 0 .. 232")) << id;
    }
    EXPECT_THAT(refusal({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "localhost"}}), HasSubstr("SUBNET, LOCALHOST, OFF"));
    EXPECT_THAT(refusal({{"ROS_LOCALHOST_ONLY", "yes"}}), HasSubstr("allowed: 0, 1"));
    EXPECT_THAT(refusal({{"ROS_STATIC_PEERS", "a;\"/><x"}}), HasSubstr("names and addresses"));
}

TEST(Ros2Domain, SmallBuffersAreToldWithTheCommand) {
    EXPECT_EQ(small_buffers_text(0, 0), "") << "unknown";
    EXPECT_EQ(small_buffers_text(4 << 20, 4 << 20), "");
    EXPECT_THAT(
        small_buffers_text(212992, 212992),
        HasSubstr("sysctl -w net.core.rmem_max=4194304 net.core.rmem_default=4194304 net.core.wmem_max=4194304"));
    EXPECT_THAT(small_buffers_text(212992, 4 << 20), Not(HasSubstr("wmem_max")));
}

}  // namespace
}  // namespace disparityd::ros2
