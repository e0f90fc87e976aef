// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/token_guesses.h"

#include <gtest/gtest.h>

namespace disparityd::web {
namespace {

using namespace std::chrono_literals;

constexpr TokenGuesses::Time begin{1000h};

TEST(TokenGuessesTest, TenMayBeWrongAndOneMoreEachSixSeconds) {
    TokenGuesses guesses;
    for (int i = 0; i < 10; ++i) {
        EXPECT_FALSE(guesses.blocks("a", begin)) << i;
        guesses.count("a", begin);
    }
    EXPECT_TRUE(guesses.blocks("a", begin));
    EXPECT_FALSE(guesses.blocks("b", begin)) << "others wait for nothing";
    EXPECT_TRUE(guesses.blocks("a", begin + 5s));
    EXPECT_FALSE(guesses.blocks("a", begin + 6s));
    guesses.count("a", begin + 6s);
    EXPECT_TRUE(guesses.blocks("a", begin + 11s));
    EXPECT_FALSE(guesses.blocks("a", begin + 12s));
}

TEST(TokenGuessesTest, AfterAMinuteAllIsForgotten) {
    TokenGuesses guesses;
    for (int i = 0; i < 10; ++i) {
        guesses.count("a", begin);
    }
    for (int i = 0; i < 10; ++i) {
        EXPECT_FALSE(guesses.blocks("a", begin + 60s)) << i;
        guesses.count("a", begin + 60s);
    }
    EXPECT_TRUE(guesses.blocks("a", begin + 60s));
}

TEST(TokenGuessesTest, ManySendersDoNotPushOutTheOneThatGuessesMost) {
    TokenGuesses guesses;
    for (int i = 0; i < 10; ++i) {
        guesses.count("a", begin);
    }
    for (int i = 0; i < 5000; ++i) {
        guesses.count(std::to_string(i), begin + 1s);
    }
    EXPECT_TRUE(guesses.blocks("a", begin + 1s));
}

TEST(TokenGuessesTest, SendersAreAddressesAndNetworksOfIpv6) {
    const auto sender = [](const char* text) { return sender_of(boost::asio::ip::make_address(text)); };
    EXPECT_EQ(sender("192.168.1.5"), "192.168.1.5");
    EXPECT_NE(sender("192.168.1.5"), sender("192.168.1.6"));
    EXPECT_EQ(sender("2001:db8:1:2:3:4:5:6"), sender("2001:db8:1:2::1"));
    EXPECT_NE(sender("2001:db8:1:2::1"), sender("2001:db8:1:3::1"));
    EXPECT_NE(sender("::ffff:192.168.1.5"), sender("::ffff:192.168.1.6"));
}

}  // namespace
}  // namespace disparityd::web
