// SPDX-License-Identifier: Apache-2.0
//
// The header of messages, in bytes that were worked out by hand.
#include <gtest/gtest.h>

#include "bridges/ros_messages/message_header.h"
#include "tests/bridges/ros_messages/cdr_reader.h"

namespace disparityd::ros {
namespace {

using test::bytes;

TEST(RosHeader, AStampIsSecondsAndNanoseconds) {
    CdrWriter cdr;
    write_header(cdr, 258'000'000'003, "l");
    EXPECT_EQ(cdr.take(), bytes({0, 1, 0, 0,              // header
                                 2, 1, 0, 0, 3, 0, 0, 0,  // 258 s, 3 ns
                                 2, 0, 0, 0, 'l', 0}));
}

TEST(RosHeader, NanosecondsCountUpwardsBefore1970) {
    CdrWriter cdr;
    write_header(cdr, -1, "");
    EXPECT_EQ(cdr.take(), bytes({0, 1, 0, 0,                                      // header
                                 0xff, 0xff, 0xff, 0xff, 0xff, 0xc9, 0x9a, 0x3b,  // -1 s, 999999999 ns
                                 1, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace disparityd::ros
