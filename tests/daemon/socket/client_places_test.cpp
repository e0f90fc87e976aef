// SPDX-License-Identifier: Apache-2.0
//
// How many clients are served, and that those of the Unix socket always find a place.
#include "daemon/socket/client_places.h"

#include <gmock/gmock.h>

#include "tests/daemon/socket/server_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::size_t plenty = 100'000;

TEST(ClientPlaces, AQuarterIsKeptForTheUnixSocket) {
    EXPECT_EQ(daemon::ClientPlaces(64, plenty, true, true).for_tcp(), 48U);
    EXPECT_EQ(daemon::ClientPlaces(3, plenty, true, true).for_tcp(), 2U);
    EXPECT_EQ(daemon::ClientPlaces(2, plenty, true, true).for_tcp(), 1U);
    EXPECT_EQ(daemon::ClientPlaces(1, plenty, true, true).for_tcp(), 1U) << "or nobody could come over TCP";
    EXPECT_EQ(daemon::ClientPlaces(64, plenty, true, false).for_tcp(), 64U) << "there is no Unix socket";
    const daemon::ClientPlaces places(8, plenty, true, true);
    EXPECT_TRUE(places.free_for(false, 5, 5));
    EXPECT_FALSE(places.free_for(false, 6, 6));
    EXPECT_TRUE(places.free_for(true, 6, 6));
    EXPECT_TRUE(places.free_for(true, 7, 0)) << "they may have all places";
    EXPECT_FALSE(places.free_for(true, 8, 6));
    EXPECT_FALSE(places.free_for(false, 8, 0));
    EXPECT_EQ(places.notice(), "");
}

TEST(ClientPlaces, FewerDescriptorsAreFewerClients) {
    constexpr std::size_t others = daemon::ClientPlaces::reserved_descriptors + daemon::ClientPlaces::max_refused;
    const daemon::ClientPlaces places(1024, others + 100, true, true);
    EXPECT_EQ(places.all(), 100U);
    EXPECT_EQ(places.for_tcp(), 75U);
    EXPECT_THAT(places.notice(), AllOf(HasSubstr("at most 100 clients"), HasSubstr("max_clients = 1024"),
                                       HasSubstr("may have 244 file descriptors"), HasSubstr("LimitNOFILE")));
    EXPECT_THAT(places.refusal(true), AllOf(HasSubstr("serves 100 clients"), HasSubstr("file descriptors")));
    EXPECT_EQ(daemon::ClientPlaces(100, others + 100, true, true).notice(), "");
    EXPECT_EQ(daemon::ClientPlaces(64, others, true, true).all(), 1U);
    EXPECT_EQ(daemon::ClientPlaces(64, 3, true, true).all(), 1U);
}

using ClientPlacesTest = ServerTest;

TEST_F(ClientPlacesTest, TcpClientsLeaveRoomForTheUnixSocket) {
    start(8);
    std::vector<WireClient> tcp;
    for (int i = 0; i < 6; ++i) {
        tcp.push_back(connect(tcp_));
    }
    {
        WireClient refused(tcp_);
        EXPECT_THAT(refused.receive_error(),
                    AllOf(HasSubstr("6 clients over TCP already; 2 more"), HasSubstr("kept for the Unix socket")));
        EXPECT_TRUE(refused.is_closed());
    }
    WireClient owner = connect(unix_);
    WireClient second = connect(unix_);
    EXPECT_EQ(status(owner).clients_size(), 8);
    WireClient third(unix_);
    EXPECT_THAT(third.receive_error(), HasSubstr("serves 8 clients already"));

    config_.max_clients = 16;
    server_->reconfigure(config_);
    connect(tcp_);
    EXPECT_EQ(status(owner).notices_size(), 0);
    config_.descriptors = daemon::ClientPlaces::reserved_descriptors + daemon::ClientPlaces::max_refused + 9;
    server_->reconfigure(config_);
    v1::Status now = status(owner);
    ASSERT_EQ(now.notices_size(), 1);
    EXPECT_THAT(now.notices(0), HasSubstr("at most 9 clients are served"));
}

}  // namespace
}  // namespace disparityd::test
