// SPDX-License-Identifier: Apache-2.0
//
// Who may ask for what: everybody who connects may look, but not everybody may record or set the camera.
#include <algorithm>

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "tests/daemon/socket/server_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ClientRightsTest : public ServerTest {};

TEST_F(ClientRightsTest, ControlOverTcpIsRefusedUnlessConfigured) {
    start();
    WireClient tcp = connect(tcp_);
    WireClient local = connect(unix_);
    for (const v1::Envelope& request : control_requests()) {
        EXPECT_THAT(ask(tcp, request),
                    AllOf(HasSubstr("refused over TCP"), HasSubstr("[socket] tcp_control = true"), HasSubstr(unix_)));
        EXPECT_EQ(ask(local, request), "");
    }
    v1::Envelope look;
    look.mutable_camera_request();
    EXPECT_EQ(ask(tcp, look), "camera: nothing asked for") << "looking is allowed; this is the camera's own answer";
    EXPECT_NO_THROW(status(tcp));

    config_.access.tcp_control = true;
    server_->reconfigure(config_);
    for (const v1::Envelope& request : control_requests()) {
        EXPECT_EQ(ask(tcp, request), "");
    }
    EXPECT_FALSE(asked_by_owner_) << "nobody knows who connects over TCP";
}

TEST_F(ClientRightsTest, TheDaemonsUserIsKnownOnTheUnixSocket) {
    start();
    WireClient client = connect(unix_);
    EXPECT_EQ(ask(client, control_requests()[0]), "");
    EXPECT_TRUE(asked_by_owner_);
}

TEST_F(ClientRightsTest, AnotherUserIsKnownToo) {
    if (geteuid() != 0) {
        GTEST_SKIP() << "only root can be somebody else";
    }
    start();
    ASSERT_EQ(chmod(config_.unix_path.c_str(), 0666), 0);
    // Of this thread alone; the server's keeps its user.
    const auto be = [](uid_t user) { return syscall(SYS_setresuid, -1, user, -1); };
    ASSERT_EQ(be(65534), 0);
    WireClient client = connect(unix_);
    ASSERT_EQ(be(0), 0);
    EXPECT_EQ(ask(client, control_requests()[0]), "");
    EXPECT_FALSE(asked_by_owner_);
}

TEST_F(ClientRightsTest, GroupsDecideOnTheUnixSocket) {
    constexpr gid_t lookers = 61001;
    constexpr gid_t pilots = 61002;
    std::vector<gid_t> own(static_cast<std::size_t>(std::max(0, getgroups(0, nullptr))));
    getgroups(static_cast<int>(own.size()), own.data());
    // Of this thread alone; the server's keeps its groups.
    const auto set_groups = [](const std::vector<gid_t>& groups) {
        return syscall(SYS_setgroups, groups.size(), groups.data());
    };
    if (geteuid() != 0 || set_groups(own) != 0) {
        GTEST_SKIP() << "only root can have other groups";
    }
    config_.access.view_groups = {{lookers, "lookers"}};
    config_.access.control_groups = {{pilots, "pilots"}};
    start();
    ASSERT_EQ(chmod(config_.unix_path.c_str(), 0666), 0);
    const auto connect_as = [&](const std::vector<gid_t>& groups) {
        EXPECT_EQ(set_groups(groups), 0);
        EXPECT_EQ(syscall(SYS_setresuid, -1, 65534, -1), 0);
        WireClient client(unix_);
        EXPECT_EQ(syscall(SYS_setresuid, -1, 0, -1), 0);
        EXPECT_EQ(set_groups(own), 0);
        return client;
    };
    WireClient pilot = connect_as({5, pilots});
    ASSERT_TRUE(pilot.hello()->has_welcome());
    WireClient looker = connect_as({lookers});
    ASSERT_TRUE(looker.hello()->has_welcome());
    for (const v1::Envelope& request : control_requests()) {
        EXPECT_EQ(ask(pilot, request), "");
        EXPECT_THAT(ask(looker, request), AllOf(HasSubstr("user 65534"), HasSubstr("members of pilots")));
    }
    EXPECT_NO_THROW(status(looker));
    WireClient nobody = connect_as({5});
    const auto refused = nobody.hello();
    ASSERT_TRUE(refused && refused->has_error());
    EXPECT_THAT(refused->error().message(), HasSubstr("members of lookers ([access] view_groups)"));
    EXPECT_TRUE(nobody.is_closed());
    WireClient root = connect(unix_);
    EXPECT_EQ(ask(root, control_requests()[0]), "");
}

}  // namespace
}  // namespace disparityd::test
