// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/client_access.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <gmock/gmock.h>
#include <grp.h>
#include <sys/socket.h>

namespace disparityd::daemon {
namespace {

using base::Right;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* view_token = "0123456789abcdef";
constexpr const char* control_token = "fedcba9876543210";

/// Somebody on the Unix socket who is neither root nor the daemon's user.
ClientPeer member_of(std::vector<gid_t> groups) {
    return {.address = "unix", .local = true, .user = geteuid() + 1, .groups = std::move(groups)};
}

ClientPeer over_tls(std::optional<std::string> certificate = std::nullopt) {
    return {.address = "tls:", .user = {}, .encrypted = true, .certificate = std::move(certificate)};
}

TEST(ClientAccessTest, WithoutRulesTheUnixSocketControlsAndTcpLooks) {
    const ClientAccess access;
    EXPECT_EQ(access.right_of(member_of({}), ""), Right::control);
    const ClientPeer tcp{.address = "tcp:", .user = {}};
    EXPECT_EQ(access.right_of(tcp, ""), Right::view);
    EXPECT_THAT(access.why_not_control(tcp), AllOf(HasSubstr("refused over TCP"), HasSubstr("tcp_control = true")));
    EXPECT_EQ(ClientAccess{.tcp_control = true}.right_of(tcp, ""), Right::control);
}

TEST(ClientAccessTest, GroupsOfTheUnixSocketLookOrControl) {
    const ClientAccess access{.view_groups = {{100, "lookers"}}, .control_groups = {{200, "pilots"}, {201, "crew"}}};
    EXPECT_EQ(access.right_of(member_of({5, 201}), ""), Right::control);
    EXPECT_EQ(access.right_of(member_of({100}), ""), Right::view);
    EXPECT_EQ(access.right_of(member_of({5}), ""), Right::none);
    EXPECT_EQ(access.right_of(member_of({}), ""), Right::none);
    EXPECT_THAT(access.why_not_control(member_of({100})),
                HasSubstr("members of pilots or crew ([access] control_groups)"));
    EXPECT_THAT(access.why_not_view(member_of({5}), ""), HasSubstr("members of lookers ([access] view_groups)"));
    ClientPeer owner = member_of({});
    owner.user = geteuid();
    EXPECT_EQ(access.right_of(owner, ""), Right::control) << "the daemon's own user";
    owner.user = 0;
    EXPECT_EQ(access.right_of(owner, ""), Right::control) << "root";
    owner.user.reset();
    EXPECT_EQ(access.right_of(owner, ""), Right::none) << "a system that does not say who it is";
}

TEST(ClientAccessTest, OneListAloneLeavesTheOtherRightAsItIs) {
    const ClientAccess control{.control_groups = {{200, "pilots"}}};
    EXPECT_EQ(control.right_of(member_of({5}), ""), Right::view) << "whoever can open the socket may look";
    const ClientAccess view{.view_groups = {{100, "lookers"}}};
    EXPECT_EQ(view.right_of(member_of({100}), ""), Right::control) << "whoever may look may control";
    EXPECT_EQ(view.right_of(member_of({5}), ""), Right::none);
}

TEST(ClientAccessTest, ATokenHasItsRight) {
    const ClientAccess access{.encrypted = true, .tokens = {{view_token}, {control_token}}};
    EXPECT_EQ(access.right_of(over_tls(), view_token), Right::view);
    EXPECT_EQ(access.right_of(over_tls(), control_token), Right::control);
    EXPECT_EQ(access.right_of(over_tls(), ""), Right::none);
    EXPECT_EQ(access.right_of(over_tls(), "0123456789abcdeg"), Right::none);
    EXPECT_THAT(access.why_not_view(over_tls(), ""), HasSubstr("a token is needed"));
    EXPECT_THAT(access.why_not_view(over_tls(), "wrong"),
                AllOf(HasSubstr("not known"), testing::Not(HasSubstr("wrong"))));
    EXPECT_THAT(access.why_not_control(over_tls()), HasSubstr("a token with the right control"));
    EXPECT_EQ(access.right_of(member_of({}), ""), Right::control) << "the Unix socket needs none";
}

TEST(ClientAccessTest, ACertificateIsKnownByItsWholeName) {
    const ClientAccess access{.encrypted = true, .certificates = true, .control_certificates = {"pilot"}};
    EXPECT_EQ(access.right_of(over_tls("pilot"), ""), Right::control);
    for (const char* other : {"pilo", "pilot2", "Pilot", "", "pilot "}) {
        EXPECT_EQ(access.right_of(over_tls(other), ""), Right::view) << other;
    }
    EXPECT_THAT(access.why_not_control(over_tls("guest")),
                AllOf(HasSubstr("control_certificates"), HasSubstr("\"guest\"")));
}

TEST(ClientAccessTest, WhatIsAskedForAfterAReloadHoldsForThoseWhoAreThere) {
    const ClientAccess access{.encrypted = true, .certificates = true};
    EXPECT_EQ(access.right_of({.address = "tcp:", .user = {}}, ""), Right::none);
    EXPECT_EQ(access.right_of(over_tls(), ""), Right::none);
    EXPECT_EQ(access.right_of(over_tls(""), ""), Right::view);
}

TEST(ClientAccessTest, GroupsAreFoundByNameAndNumber) {
    const ::group* const own = ::getgrgid(getegid());
    ASSERT_NE(own, nullptr);
    const std::string name = own->gr_name;
    const auto groups = find_groups({name, std::to_string(getegid())}, "[access] view_groups");
    ASSERT_EQ(groups.size(), 2U);
    EXPECT_EQ(groups[0].number, getegid());
    EXPECT_EQ(groups[0].name, name);
    EXPECT_EQ(groups[1].number, getegid());
    try {
        find_groups({"no-such-group"}, "[access] view_groups");
        FAIL() << "an unknown group is taken";
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(),
                    AllOf(HasSubstr("[access] view_groups: found \"no-such-group\""), HasSubstr("getent")));
    }
}

TEST(ClientAccessTest, TheSystemTellsAllGroupsOfAPeer) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
    const std::vector<gid_t> found = groups_of_peer(ends[0]);
    std::vector<gid_t> own(static_cast<std::size_t>(std::max(0, ::getgroups(0, nullptr))));
    ASSERT_EQ(::getgroups(static_cast<int>(own.size()), own.data()), static_cast<int>(own.size()));
    own.push_back(getegid());
    for (const gid_t group : own) {
        EXPECT_NE(std::find(found.begin(), found.end(), group), found.end()) << group;
    }
    ::close(ends[0]);
    ::close(ends[1]);
}

}  // namespace
}  // namespace disparityd::daemon
