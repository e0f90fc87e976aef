// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/token_guesses.h"

#include <gtest/gtest.h>

namespace disparityd::web {
namespace {

using namespace std::chrono_literals;

constexpr TokenGuesses::Time begin{1000h};

/// Returns how many of so many wrong tokens were too many.
int too_many(TokenGuesses& guesses, const std::string& sender, TokenGuesses::Time now, int count) {
    int found = 0;
    for (int i = 0; i < count; ++i) {
        found += guesses.count(sender, now) ? 1 : 0;
    }
    return found;
}

TEST(TokenGuessesTest, TenMayBeWrongAndOneMoreEachSixSeconds) {
    TokenGuesses guesses;
    EXPECT_EQ(too_many(guesses, "a", begin, 15), 5);
    EXPECT_EQ(too_many(guesses, "b", begin, 1), 0) << "others wait for nothing";
    EXPECT_EQ(too_many(guesses, "a", begin + 5s, 1), 1);
    EXPECT_EQ(too_many(guesses, "a", begin + 6s, 2), 1);
    EXPECT_EQ(too_many(guesses, "a", begin + 11s, 1), 1);
    EXPECT_EQ(too_many(guesses, "a", begin + 12s, 1), 0);
}

TEST(TokenGuessesTest, AfterAMinuteAllIsForgotten) {
    TokenGuesses guesses;
    too_many(guesses, "a", begin, 1000);
    EXPECT_EQ(too_many(guesses, "a", begin + 60s, 11), 1);
}

TEST(TokenGuessesTest, ManySendersTogetherAreTooMany) {
    TokenGuesses guesses;
    int found = 0;
    for (int i = 0; i < 2000; ++i) {
        found += guesses.count(std::to_string(i), begin) ? 1 : 0;
    }
    EXPECT_EQ(found, 1900);
    EXPECT_TRUE(guesses.count("a", begin + 599ms));
    EXPECT_FALSE(guesses.count("b", begin + 600ms)) << "a hundred in a minute";
    EXPECT_TRUE(guesses.count("c", begin + 600ms));
}

TEST(TokenGuessesTest, ManySendersDoNotPushOutTheOneThatGuessesMost) {
    TokenGuesses guesses;
    too_many(guesses, "a", begin, 10);
    for (int i = 0; i < 5000; ++i) {
        guesses.count(std::to_string(i), begin + 1s + i * 600ms / 5000);
    }
    EXPECT_TRUE(guesses.count("a", begin + 2s));
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
