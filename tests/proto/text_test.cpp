// SPDX-License-Identifier: Apache-2.0
#include "proto/text.h"

#include <gtest/gtest.h>

#include "proto/disparity.pb.h"

namespace disparityd::proto {
namespace {

TEST(MessageText, IsUtf8) {
    EXPECT_EQ(to_valid_utf8(""), "");
    EXPECT_EQ(to_valid_utf8("caf\xc3\xa9 \xe6\xb7\xb1 \xf0\x9f\x93\xb7\n"),
              "caf\xc3\xa9 \xe6\xb7\xb1 \xf0\x9f\x93\xb7\n");
    EXPECT_EQ(to_valid_utf8("caf\xe9"), "caf?");           // Latin 1
    EXPECT_EQ(to_valid_utf8("\xe9.mkv"), "?.mkv");         // promises two more bytes
    EXPECT_EQ(to_valid_utf8("\x80\xbf\xff"), "???");       // begins nothing
    EXPECT_EQ(to_valid_utf8("\xc0\xaf"), "??");            // longer than it must be
    EXPECT_EQ(to_valid_utf8("\xed\xa0\x80"), "???");       // half of a pair of UTF-16
    EXPECT_EQ(to_valid_utf8("\xf4\x90\x80\x80"), "????");  // beyond U+10FFFF
    EXPECT_EQ(to_valid_utf8("a\xf0\x9f\x93"), "a???");     // cut off
}

TEST(MessageText, CanBeReadBack) {
    for (int first = 0; first < 256; ++first) {
        for (int second = 0; second < 256; ++second) {
            const std::string bytes{static_cast<char>(first), static_cast<char>(second), '.'};
            v1::Status sent;
            sent.set_source(to_valid_utf8(bytes));
            v1::Status got;
            ASSERT_TRUE(got.ParseFromString(sent.SerializeAsString())) << first << ' ' << second;
            EXPECT_EQ(got.source().size(), bytes.size());
        }
    }
}

}  // namespace
}  // namespace disparityd::proto
