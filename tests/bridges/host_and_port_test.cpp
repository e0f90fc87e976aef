// SPDX-License-Identifier: Apache-2.0
#include "bridges/program/host_and_port.h"

#include <string>

#include <gtest/gtest.h>

namespace disparityd::bridges {
namespace {

std::string shown(const std::optional<NameAndNumber>& read) {
    return read ? read->name + " and " + std::to_string(read->number) : "nothing";
}

TEST(HostAndPort, AreDividedAtTheLastColon) {
    EXPECT_EQ(shown(parse_host_and_port("robot:14550")), "robot and 14550");
    EXPECT_EQ(shown(parse_host_and_port("::1:80")), "::1 and 80");
}

TEST(HostAndPort, AHostInBracketsLosesThem) {
    EXPECT_EQ(shown(parse_host_and_port("[::1]:0")), "::1 and 0");
    // Half a pair, or nothing inside, is no host: whoever looks it up says so.
    EXPECT_EQ(shown(parse_host_and_port("[::1:80")), "[::1 and 80");
    EXPECT_EQ(shown(parse_host_and_port("[]:80")), "[] and 80");
}

TEST(HostAndPort, APortThatIsTooLargeIsReadForTheMessage) {
    EXPECT_EQ(shown(parse_host_and_port("robot:65536")), "robot and 65536");
}

TEST(HostAndPort, AnythingElseIsNothing) {
    for (const char* wrong : {"", ":", ":80", "robot", "8765", "robot:", "robot:-1", "robot:+1", "robot: 1",
                              "robot:80x", "robot:0x50", "robot:99999999999", "[::1]"}) {
        EXPECT_EQ(shown(parse_host_and_port(wrong)), "nothing") << wrong;
        EXPECT_EQ(shown(parse_name_and_number(wrong)), "nothing") << wrong;
    }
}

TEST(NameAndNumber, KeepsBrackets) {
    EXPECT_EQ(shown(parse_name_and_number("/dev/ttyACM0:921600")), "/dev/ttyACM0 and 921600");
    EXPECT_EQ(shown(parse_name_and_number("[a]:1")), "[a] and 1");
}

}  // namespace
}  // namespace disparityd::bridges
