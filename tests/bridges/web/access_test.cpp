// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/access.h"

#include <gmock/gmock.h>

namespace disparityd::web {
namespace {

using ::testing::HasSubstr;

constexpr const char* view_token = "0123456789abcdef";
constexpr const char* control_token = "fedcba9876543210";

AccessRules with_tokens() {
    AccessRules rules;
    rules.anybody_views = false;
    rules.tokens = {{view_token}, {control_token}};
    return rules;
}

Visitor bearing(const std::string& authorization) {
    Visitor visitor;
    visitor.authorization = authorization;
    return visitor;
}

TEST(AccessTest, AnAddressAndOwnNamesAreHosts) {
    AccessRules rules;
    rules.hosts = {"robot.example"};
    const Access access(rules, false);
    for (const char* host : {"127.0.0.1:8765", "127.0.0.1", "[::1]:8765", "192.168.1.5:8765", "localhost:8765",
                             "LOCALHOST", "Robot.Example:8765"}) {
        EXPECT_EQ(access.refuses({host, {}, {}, {}}), "") << host;
    }
}

TEST(AccessTest, ANameThatSomebodyPointedHereIsRefused) {
    const Access access(AccessRules{}, false);
    for (const char* host :
         {"evil.example:8765", "127.0.0.1.evil.example", "localhost.evil.example", "", "[::1", ":80"}) {
        EXPECT_THAT(access.refuses({host, {}, {}, {}}), HasSubstr("--host")) << host;
    }
}

TEST(AccessTest, OnlyPagesOfThisServerAndNamedOnesMayUseIt) {
    AccessRules rules;
    rules.origins = {"https://app.example.org"};
    const Access access(rules, false);
    const auto why = [&](const char* origin) { return access.refuses({"127.0.0.1:8765", origin, {}, {}}); };
    EXPECT_EQ(why("http://127.0.0.1:8765"), "");
    EXPECT_EQ(why("https://app.example.org"), "");
    for (const char* origin : {"http://evil.example", "http://127.0.0.1:9999", "https://127.0.0.1:8765", "null",
                               "http://127.0.0.1:8765.evil.example", "https://app.example.org.evil.example"}) {
        EXPECT_THAT(why(origin), HasSubstr("--origin")) << origin;
    }
}

TEST(AccessTest, ASecureServersOriginIsHttps) {
    const Access access(AccessRules{}, true);
    EXPECT_EQ(access.refuses({"127.0.0.1:8765", "https://127.0.0.1:8765", {}, {}}), "");
    EXPECT_NE(access.refuses({"127.0.0.1:8765", "http://127.0.0.1:8765", {}, {}}), "");
}

TEST(AccessTest, WhoMayLookMayNotControl) {
    AccessRules rules;
    EXPECT_EQ(Access(rules, false).right_of({}), Right::view);
    rules.anybody_controls = true;
    EXPECT_EQ(Access(rules, false).right_of({}), Right::control);
}

TEST(AccessTest, TokensGiveTheirRight) {
    const Access access(with_tokens(), false);
    EXPECT_TRUE(access.needs_token());
    EXPECT_EQ(access.right_of({}), Right::none);
    EXPECT_EQ(access.right_of(bearing(std::string("Bearer ") + view_token)), Right::view);
    EXPECT_EQ(access.right_of(bearing(std::string("Bearer ") + control_token)), Right::control);
    for (const char* wrong : {"Bearer ", "Bearer 0123456789abcde", "Bearer 0123456789abcdef0", "Basic 0123456789abcdef",
                              "0123456789abcdef", "bearer"}) {
        EXPECT_EQ(access.right_of(bearing(wrong)), Right::none) << wrong;
    }
}

TEST(AccessTest, ALogInGivesACookieWithTheTokensRight) {
    Access access(with_tokens(), true);
    EXPECT_EQ(access.log_in("wrong", "robot:8765"), "");
    EXPECT_EQ(access.log_in("", "robot:8765"), "");
    const std::string cookie = access.log_in(control_token, "robot:8765");
    EXPECT_THAT(cookie, HasSubstr("; HttpOnly; SameSite=Strict; Secure"));
    EXPECT_THAT(cookie, testing::Not(HasSubstr(control_token)));
    const std::string pair = cookie.substr(0, cookie.find(';'));
    Visitor visitor;
    visitor.host = "robot:8765";
    visitor.cookie = pair;
    EXPECT_EQ(access.right_of(visitor), Right::control);
    const std::string among_others = "a=b; " + pair + "; c=d";
    visitor.cookie = among_others;
    EXPECT_EQ(access.right_of(visitor), Right::control);
    const std::string wrong = pair + "0";
    visitor.cookie = wrong;
    EXPECT_EQ(access.right_of(visitor), Right::none);
    EXPECT_NE(access.log_in(view_token, "robot:8765"), cookie);
}

Visitor with_cookie(const std::string& pair, std::string_view host) {
    Visitor visitor;
    visitor.host = host;
    visitor.cookie = pair;
    return visitor;
}

std::string pair_of(const std::string& cookie) {
    return cookie.substr(0, cookie.find(';'));
}

TEST(AccessTest, AViewersLogInsLogOutNoController) {
    Access access(with_tokens(), false);
    const std::string controller = pair_of(access.log_in(control_token, "robot:8765"));
    const std::string first_viewer = pair_of(access.log_in(view_token, "robot:8765"));
    std::string last_viewer;
    for (int i = 0; i < 2000; ++i) {
        last_viewer = pair_of(access.log_in(view_token, "robot:8765"));
    }
    EXPECT_EQ(access.right_of(with_cookie(controller, "robot:8765")), Right::control);
    EXPECT_EQ(access.right_of(with_cookie(last_viewer, "robot:8765")), Right::view);
    EXPECT_EQ(access.right_of(with_cookie(first_viewer, "robot:8765")), Right::none) << "sessions have a limit";
}

TEST(AccessTest, TwoServersOnAHostHaveCookiesOfTheirOwn) {
    Access access(with_tokens(), false);
    const auto name = [&](std::string_view host) {
        const std::string cookie = access.log_in(view_token, host);
        return cookie.substr(0, cookie.find('='));
    };
    EXPECT_EQ(name("127.0.0.1:8765"), "disparityd_8765");
    EXPECT_EQ(name("[::1]:8766"), "disparityd_8766");
    EXPECT_EQ(name("robot.local"), "disparityd_");
    EXPECT_EQ(name("[::1]"), "disparityd_");
    EXPECT_EQ(name("robot:80; Domain=x"), "disparityd_") << "nothing of the visitor's but digits";
    const std::string pair = pair_of(access.log_in(view_token, "robot:8765"));
    EXPECT_EQ(access.right_of(with_cookie("disparityd_8766=0; " + pair, "robot:8765")), Right::view);
    EXPECT_EQ(access.right_of(with_cookie(pair, "robot:8766")), Right::none);
}

TEST(AccessTest, WhatIsAnOrigin) {
    for (const char* text : {"https://app.example.org", "http://localhost:8080", "http://[::1]:8080", "file://",
                             "http://127.0.0.1", "vscode-webview://abc-1"}) {
        EXPECT_TRUE(is_origin(text)) << text;
    }
    for (const char* text :
         {"", "x", "app.example.org", "https://", "://x", "https://app.example.org/", "https://app.example.org/a",
          "https://app.example.org:", "https://app.example.org:x", "http://a b", "http://a@b", "http://a,http://b",
          "file:///home", "null", "*", "http://*.example.org", "http://[]:80", "http://::1"}) {
        EXPECT_FALSE(is_origin(text)) << text;
    }
}

}  // namespace
}  // namespace disparityd::web
