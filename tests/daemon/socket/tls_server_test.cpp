// SPDX-License-Identifier: Apache-2.0
//
// The server over TLS: the same frames as without, and nothing for those who do not show who they are.
#include <gmock/gmock.h>

#include "proto/framing.h"
#include "tests/certificate_folder.h"
#include "tests/daemon/socket/server_fixture.h"
#include "tests/daemon/tls_wire_client.h"

namespace disparityd::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Facts = CertificateFolder::Facts;
using namespace std::chrono_literals;

constexpr const char* view_token = "0123456789abcdef";
constexpr const char* control_token = "fedcba9876543210";

class TlsServerTest : public ServerTest {
protected:
    void start_with_tls(bool certificates = false, std::size_t max_clients = 64) {
        config_.access.certificates = certificates;
        config_.tls = proto::make_server_tls(files_.server(certificates), "test");
        start(max_clients);
        EXPECT_TRUE(tcp_.starts_with("tls:127.0.0.1:")) << tcp_;
    }

    /// A client that has been let in.
    TlsWireClient enter(const std::string& token = "", const std::string& certificate = "") {
        TlsWireClient client(tcp_, files_.client(certificate));
        const auto answer = client.hello("test", token);
        EXPECT_TRUE(answer && answer->has_welcome()) << (answer ? answer->error().message() : client.problem());
        return client;
    }

    /// Why a client is not let in: the daemon's Error, else OpenSSL's reason.
    std::string refusal(const std::string& token, const proto::TlsFiles& files) {
        try {
            TlsWireClient client(tcp_, files);
            const auto answer = client.hello("test", token);
            if (!answer) {
                return client.problem();
            }
            EXPECT_TRUE(answer->has_error() && answer->error().closing());
            EXPECT_TRUE(client.is_closed(60s));
            return answer->error().message();
        } catch (const std::runtime_error& error) {
            return error.what();
        }
    }

    void expect_view_only(WireClient& client, const std::string& why) {
        for (const v1::Envelope& request : control_requests()) {
            EXPECT_THAT(ask(client, request), HasSubstr(why));
        }
        EXPECT_NO_THROW(status(client));
    }

    void expect_control(WireClient& client) {
        for (const v1::Envelope& request : control_requests()) {
            EXPECT_EQ(ask(client, request), "");
        }
    }

    CertificateFolder files_;
};

TEST_F(TlsServerTest, FramesAreThoseOfTheUnixSocket) {
    // Larger than a record of TLS and than what a socket takes at once.
    constexpr std::uint32_t width = 1280;
    constexpr std::uint32_t height = 720;
    feed_ = PatternFrames(width, height, all_products());
    start_with_tls();
    for (const v1::Encoding encoding : {v1::RAW, v1::ZSTD}) {
        v1::Envelope wanted = subscription(all_products());
        wanted.mutable_subscribe()->set_encoding(encoding);
        WireClient plain = connect(unix_);
        TlsWireClient encrypted = enter();
        subscribe(plain, wanted);
        subscribe(encrypted, wanted);
        for (int i = 0; i < 3; ++i) {
            server_->publish(feed_.next());
            auto one = plain.receive_frame();
            auto other = encrypted.receive_frame();
            ASSERT_TRUE(one && other);
            for (auto* frame : {&one, &other}) {
                (*frame)->envelope.mutable_frame()->set_age_ns(0);
                (*frame)->envelope.mutable_frame()->set_sent_monotonic_ns(0);
            }
            EXPECT_EQ(one->envelope.SerializeAsString(), other->envelope.SerializeAsString());
            EXPECT_EQ(one->payload, other->payload);
            EXPECT_GT(one->payload.size(), 0U);
        }
    }
}

TEST_F(TlsServerTest, ATokenLetsInAndSaysWhatItMayDo) {
    config_.access.tokens = {{view_token}, {control_token}};
    start_with_tls();
    TlsWireClient viewer = enter(view_token);
    expect_view_only(viewer, "a token with the right control");
    TlsWireClient controller = enter(control_token);
    expect_control(controller);
    EXPECT_FALSE(asked_by_owner_);
    WireClient local = connect(unix_);
    expect_control(local);
    const v1::Status now = status(local);
    ASSERT_EQ(now.clients_size(), 3);
    EXPECT_TRUE(now.clients(0).address().starts_with("tls:127.0.0.1:"));
    EXPECT_EQ(now.SerializeAsString().find(view_token), std::string::npos) << "a token is told to nobody";
}

TEST_F(TlsServerTest, WithoutATokenNobodyComesIn) {
    config_.access.tokens = {{view_token}, {}};
    start_with_tls();
    EXPECT_THAT(refusal("", files_.client()), HasSubstr("a token is needed"));
}

TEST_F(TlsServerTest, AWrongTokenIsToldLateAndARightOneWaitsForNobody) {
    config_.access.tokens = {{view_token}, {}};
    start_with_tls();
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_THAT(refusal("0123456789abcdeg", files_.client()),
                AllOf(HasSubstr("this token is not known"), testing::Not(HasSubstr("0123456789"))));
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 1s);
    // One that sends more while it waits is not read.
    TlsWireClient guesser(tcp_, files_.client());
    v1::Envelope guess;
    guess.mutable_hello()->set_protocol_version(proto::protocol_version);
    guess.mutable_hello()->set_token("fedcba9876543211");
    ASSERT_TRUE(guesser.send(guess));
    guess.mutable_hello()->set_token(view_token);
    ASSERT_TRUE(guesser.send(guess));
    enter(view_token);
    EXPECT_THAT(guesser.receive_error(60s), HasSubstr("not known"));
    EXPECT_TRUE(guesser.is_closed(60s));
}

TEST_F(TlsServerTest, ACertificateLetsInAndItsNameControls) {
    files_.make({.common_name = "guest"});
    files_.make({.common_name = "pilot"});
    config_.access.control_certificates = {"pilot"};
    start_with_tls(true);
    TlsWireClient guest = enter("", "guest");
    expect_view_only(guest, "[access] control_certificates with the name \"guest\"");
    TlsWireClient pilot = enter("", "pilot");
    expect_control(pilot);
}

TEST_F(TlsServerTest, OtherCertificatesLetNobodyIn) {
    files_.make({.common_name = "expired", .valid_from = -std::chrono::hours(48), .valid_to = -std::chrono::hours(24)});
    files_.make({.common_name = "early", .valid_from = std::chrono::hours(24), .valid_to = std::chrono::hours(48)});
    const tools::Certificate foreign_authority = tools::make_certificate(
        {.purpose = Facts::Purpose::authority, .common_name = "authority of the tests"}, nullptr);
    files_.make({.common_name = "foreign"}, &foreign_authority);
    files_.make({.purpose = Facts::Purpose::server, .common_name = "a-server", .hosts = {"127.0.0.1"}});
    start_with_tls(true);
    EXPECT_THAT(refusal("", files_.client()), HasSubstr("certificate required"));
    EXPECT_THAT(refusal("", files_.client("expired")), HasSubstr("certificate expired"));
    EXPECT_NE(refusal("", files_.client("early")), "");
    EXPECT_NE(refusal("", files_.client("foreign")), "");
    EXPECT_NE(refusal("", files_.client("a-server")), "") << "a server's certificate is none of a client";
    files_.make({.common_name = "guest"});
    enter("", "guest");
}

TEST_F(TlsServerTest, WithBothAClientNeedsBoth) {
    files_.make({.common_name = "guest"});
    config_.access.tokens = {{view_token}, {control_token}};
    start_with_tls(true);
    EXPECT_THAT(refusal("", files_.client("guest")), HasSubstr("a token is needed"));
    EXPECT_THAT(refusal(view_token, files_.client()), HasSubstr("certificate required"));
    TlsWireClient viewer = enter(view_token, "guest");
    expect_view_only(viewer, "a token with the right control (the file of [socket] tokens), or");
}

TEST_F(TlsServerTest, AServerThatIsAnotherIsSeenByTheClient) {
    start_with_tls();
    EXPECT_THAT(refusal("", {"", "", files_.file("server.crt")}), HasSubstr("certificate verify failed"));
    const auto call = [&](const std::string& name) { TlsWireClient client(tcp_, files_.client(), name); };
    EXPECT_NO_THROW(call("localhost"));
    EXPECT_THROW(call("elsewhere"), std::runtime_error);
    EXPECT_THROW(call("127.0.0.2"), std::runtime_error);
}

TEST_F(TlsServerTest, APlainClientIsToldWhereToGo) {
    start_with_tls();
    WireClient plain("tcp" + tcp_.substr(3));
    const auto answer = plain.hello();
    ASSERT_TRUE(answer && answer->has_error());
    EXPECT_THAT(answer->error().message(), HasSubstr("tls:HOST:PORT"));
    EXPECT_TRUE(plain.is_closed(60s));
    enter();
}

TEST_F(TlsServerTest, ATlsClientAtAPlainPortHarmsNobody) {
    start();
    EXPECT_THROW(TlsWireClient(tcp_, files_.client()), std::runtime_error);
    connect(tcp_);
}

TEST_F(TlsServerTest, OldVersionsOfTlsAreRefused) {
    start_with_tls();
    const proto::TlsContext context = proto::make_client_tls(files_.client());
    EXPECT_EQ(SSL_CTX_get_min_proto_version(context.get()), TLS1_2_VERSION);
    EXPECT_EQ(SSL_CTX_get_min_proto_version(config_.tls.get()), TLS1_2_VERSION);
}

TEST_F(TlsServerTest, AHandshakeThatStallsEndsAndKeepsNobodyWaiting) {
    start_with_tls();
    WireClient stalled(tcp_);
    ASSERT_TRUE(stalled.send_bytes(std::array<std::uint8_t, 6>{0x16, 0x03, 0x01, 0x02, 0x00, 0x01}));
    WireClient silent(tcp_);
    TlsWireClient client = enter();
    subscribe(client, subscription({v1::DISPARITY}));
    server_->publish(feed_.next());
    EXPECT_TRUE(client.receive_frame());
    EXPECT_TRUE(stalled.is_closed(60s));
    EXPECT_TRUE(silent.is_closed(60s));
    EXPECT_EQ(status(client).clients_size(), 1);
}

TEST_F(TlsServerTest, WhoeverSaysNothingMakesPlace) {
    config_.access.tokens = {{view_token}, {}};
    start_with_tls(false, 4);  // three for TLS
    std::vector<WireClient> silent;
    for (int i = 0; i < 20; ++i) {
        silent.emplace_back(tcp_);
    }
    TlsWireClient first = enter(view_token);
    TlsWireClient second = enter(view_token);
    TlsWireClient third = enter(view_token);
    // Nobody who has come in makes place.
    EXPECT_THAT(refusal(view_token, files_.client()), HasSubstr("3 clients over TCP already"));
    EXPECT_EQ(status(first).clients_size(), 3);
    WireClient local = connect(unix_);
    EXPECT_EQ(status(local).clients_size(), 4);
}

TEST_F(TlsServerTest, AFloodOfHandshakesIsCutOff) {
    config_.handshake_interval = std::chrono::hours(1);
    start_with_tls();
    TlsWireClient client = enter();
    subscribe(client, subscription({v1::DISPARITY}));
    // Some have their turn at once; that of the others would come in an hour.
    for (int i = 0; i < 40; ++i) {
        WireClient probe(tcp_);
    }
    EXPECT_NE(refusal("", files_.client()), "");
    server_->publish(feed_.next());
    EXPECT_TRUE(client.receive_frame());
    connect(unix_);
}

TEST_F(TlsServerTest, OneThatDoesNotReadCostsNobodyAFrame) {
    feed_ = PatternFrames(1280, 720, all_products());
    start_with_tls();
    TlsWireClient slow = enter();
    subscribe(slow, subscription(all_products()));
    TlsWireClient client = enter();
    subscribe(client, subscription({v1::DISPARITY}));
    for (std::uint64_t i = 0; i < 20; ++i) {
        server_->publish(feed_.next());
        const auto frame = client.receive_frame(60s);
        ASSERT_TRUE(frame);
        EXPECT_EQ(frame->envelope.frame().publish_index(), i);
        EXPECT_EQ(frame->payload, PatternFrames::expected(i, v1::DISPARITY, 0, 0, 1280, 720));
    }
    // It reads what was on its way and goes on with the newest ones: whole frames, no bytes of another.
    std::uint64_t skipped = 0;
    for (std::uint64_t next = 0; next < 20;) {
        const auto frame = slow.receive_frame(60s);
        ASSERT_TRUE(frame);
        const std::uint64_t index = frame->envelope.frame().publish_index();
        EXPECT_EQ(frame->envelope.frame().skipped(), index - next);
        skipped += index - next;
        next = index + 1;
        const auto expected = PatternFrames::expected(index, v1::DISPARITY, 0, 0, 1280, 720);
        ASSERT_GE(frame->payload.size(), expected.size());
        EXPECT_TRUE(std::equal(expected.begin(), expected.end(), frame->payload.begin()));
    }
    EXPECT_GT(skipped, 0U) << "more than 100 MB went into the buffers of a connection";
}

TEST_F(TlsServerTest, AReloadTakesRightsAway) {
    config_.access.tokens = {{view_token}, {control_token}};
    start_with_tls();
    TlsWireClient viewer = enter(view_token);
    TlsWireClient controller = enter(control_token);
    WireClient local = connect(unix_);
    config_.access.tokens = {{control_token}, {}};
    server_->reconfigure(config_);
    EXPECT_THAT(viewer.receive_error(60s), AllOf(HasSubstr("reconfigured"), HasSubstr("not known")));
    EXPECT_TRUE(viewer.is_closed(60s));
    expect_view_only(controller, "a token with the right control");
    expect_control(local);
}

TEST_F(TlsServerTest, ARevokedCertificateEndsWithTheReload) {
    for (const char* name : {"guest", "slow", "pilot"}) {
        files_.make({.common_name = name});
    }
    start_with_tls(true);
    TlsWireClient guest = enter("", "guest");
    TlsWireClient pilot = enter("", "pilot");
    TlsWireClient slow(tcp_, files_.client("slow"));  // between its handshake and Hello
    files_.revoke("guest");
    files_.revoke("slow");
    config_.tls = proto::make_server_tls(files_.server(true), "test");
    server_->reconfigure(config_);
    EXPECT_THAT(guest.receive_error(60s), AllOf(HasSubstr("reconfigured"), HasSubstr("revoked")));
    EXPECT_TRUE(guest.is_closed(60s));
    const auto answer = slow.hello("test", "");
    ASSERT_TRUE(answer && answer->has_error());
    EXPECT_THAT(answer->error().message(), HasSubstr("revoked"));
    EXPECT_THAT(refusal("", files_.client("guest")), HasSubstr("certificate revoked"));
    EXPECT_NO_THROW(status(pilot));
    enter("", "pilot");
}

TEST_F(TlsServerTest, AReloadTakesAnAuthorityAway) {
    files_.make({.common_name = "guest"});
    start_with_tls(true);
    TlsWireClient guest = enter("", "guest");
    CertificateFolder others;
    others.make({.common_name = "guest"});
    config_.tls = proto::make_server_tls(others.server(true), "test");
    server_->reconfigure(config_);
    EXPECT_THAT(guest.receive_error(60s), HasSubstr("of no authority"));
    EXPECT_TRUE(guest.is_closed(60s));
}

TEST_F(TlsServerTest, AReloadTurnsTlsOnAtTheSamePort) {
    start();
    WireClient before = connect(tcp_);
    config_.tls = proto::make_server_tls(files_.server(), "test");
    server_->reconfigure(config_);
    EXPECT_THAT(before.receive_error(60s), HasSubstr("TLS only"));
    EXPECT_EQ(server_->addresses().at(0), "tls" + tcp_.substr(3));
    tcp_ = server_->addresses().at(0);
    enter();
}

}  // namespace
}  // namespace disparityd::test
