// SPDX-License-Identifier: Apache-2.0
//
// Connections in every phase while frames, samples, reloads and the idle watch reach all of them: none may touch the
// stream of one that shakes hands, and nobody else loses a frame.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <latch>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/socket.h>

#include "proto/framing.h"
#include "proto/tls/tls_stream.h"
#include "tests/certificate_folder.h"
#include "tests/daemon/socket/server_fixture.h"
#include "tests/daemon/tls_wire_client.h"
#include "tests/daemon/wire_client.h"

namespace disparityd::test {
namespace {

/// A connection to a port with TLS that goes on as far as chance wants: through the handshake, Hello and Subscribe,
/// each in pieces. It ends anywhere: it leaves, resets, or sends what nobody expects. It never waits.
class Stranger {
public:
    /// "tls:127.0.0.1:1234". `token`: of its Hello.
    Stranger(const std::string& address, const proto::TlsContext& context, std::string token, std::mt19937& chance);

    /// Does the next small thing. False: it has ended, and the object is of no more use.
    bool step();

    /// Whether it was let in before it ended.
    bool was_let_in() const { return let_in_; }

private:
    enum class Ending { leave, reset, no_tls, half_hello, noise, shut_output };
    void end_as(Ending ending);
    void send_raw(const std::vector<std::uint8_t>& bytes);
    bool send_next();
    bool read();

    WireClient connection_;
    proto::TlsStream tls_;
    std::mt19937& chance_;
    std::vector<std::uint8_t> to_send_;  ///< Hello and Subscribe
    bool hands_shaken_ = false;
    bool let_in_ = false;
    bool garbled_ = false;  ///< leaves next
};

Stranger::Stranger(const std::string& address, const proto::TlsContext& context, std::string token,
                   std::mt19937& chance)
    : connection_(address), tls_(context, connection_.descriptor(), proto::TlsStream::End::client), chance_(chance) {
    ::fcntl(connection_.descriptor(), F_SETFL, O_NONBLOCK);
    tls_.expect_server("127.0.0.1");
    v1::Envelope hello;
    hello.mutable_hello()->set_protocol_version(proto::protocol_version);
    hello.mutable_hello()->set_token(std::move(token));
    proto::encode(hello, to_send_);
    v1::Envelope wanted = subscription({v1::DISPARITY, v1::DEPTH});
    wanted.mutable_subscribe()->set_sensors(true);
    wanted.mutable_subscribe()->set_encoding(chance_() % 2 == 0 ? v1::RAW : v1::ZSTD);
    std::vector<std::uint8_t> bytes;
    proto::encode(wanted, bytes);
    to_send_.insert(to_send_.end(), bytes.begin(), bytes.end());
}

bool Stranger::step() {
    if (garbled_) {
        return false;
    }
    constexpr unsigned one_in = 12;
    if (chance_() % one_in == 0) {
        constexpr std::array endings{Ending::leave,      Ending::reset, Ending::no_tls,
                                     Ending::half_hello, Ending::noise, Ending::shut_output};
        const Ending ending = endings.at(chance_() % endings.size());
        end_as(ending);
        garbled_ = true;
        return ending != Ending::leave && ending != Ending::reset;  // the others see an answer, or none
    }
    if (!hands_shaken_) {
        const auto outcome = tls_.handshake();
        hands_shaken_ = outcome == proto::TlsStream::Outcome::done;
        return hands_shaken_ || proto::TlsStream::is_wanting(outcome);
    }
    return to_send_.empty() ? read() : send_next();
}

bool Stranger::send_next() {
    const std::size_t part = std::min<std::size_t>(to_send_.size(), 1 + chance_() % 24);
    std::size_t sent = 0;
    const auto outcome = tls_.write({to_send_.data(), part}, sent);
    to_send_.erase(to_send_.begin(), to_send_.begin() + static_cast<std::ptrdiff_t>(sent));
    return outcome == proto::TlsStream::Outcome::done || proto::TlsStream::is_wanting(outcome);
}

bool Stranger::read() {
    std::array<std::uint8_t, 4096> bytes{};
    std::size_t received = 0;
    const auto outcome = tls_.read(bytes, received);
    let_in_ = let_in_ || received > 0;
    return outcome == proto::TlsStream::Outcome::done || proto::TlsStream::is_wanting(outcome);
}

void Stranger::end_as(Ending ending) {
    switch (ending) {
        case Ending::leave: break;
        case Ending::reset: {
            const linger at_once{1, 0};
            ::setsockopt(connection_.descriptor(), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
            break;
        }
        case Ending::no_tls: send_raw({'X', 'X'}); break;
        case Ending::half_hello: send_raw({0x16, 0x03, 0x01, 0x02, 0x00, 0x01}); break;
        case Ending::noise: {
            std::vector<std::uint8_t> bytes(1 + chance_() % 600);
            std::generate(bytes.begin(), bytes.end(), [this] { return static_cast<std::uint8_t>(chance_()); });
            send_raw(bytes);
            break;
        }
        case Ending::shut_output: ::shutdown(connection_.descriptor(), SHUT_WR); break;
    }
}

void Stranger::send_raw(const std::vector<std::uint8_t>& bytes) {
    ::send(connection_.descriptor(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

using ::testing::HasSubstr;
using namespace std::chrono_literals;

constexpr const char* known_token = "0123456789abcdef";

/// How many strangers connect. The environment says more for a long run: 10,000 take a minute without sanitizers.
int strangers() {
    const char* const told = std::getenv("DISPARITYD_STRANGERS");
    return told == nullptr ? 300 : std::atoi(told);
}

class TlsPhasesTest : public ServerTest {
protected:
    void start_with_tls(bool certificates = false) {
        config_.access.certificates = certificates;
        config_.tls = proto::make_server_tls(files_.server(certificates), "test");
        start();
    }

    TlsWireClient enter(const std::string& certificate = "") {
        TlsWireClient client(tcp_, files_.client(certificate));
        const auto answer = client.hello("test", config_.access.tokens.empty() ? "" : known_token);
        EXPECT_TRUE(answer && answer->has_welcome()) << (answer ? answer->error().message() : client.problem());
        return client;
    }

    /// Returns false where this machine is so busy that the daemon's time for a handshake and Hello was over.
    bool comes_in(const std::string& certificate) {
        try {
            TlsWireClient client(tcp_, files_.client(certificate));
            const auto answer = client.hello("test", "");
            if (!answer || answer->error().message().find("no Hello within") != std::string::npos) {
                return false;
            }
            EXPECT_TRUE(answer->has_welcome()) << answer->error().message();
            static_cast<void>(status(client));
        } catch (const std::exception& error) {
            const std::string why = error.what();
            EXPECT_EQ(why, "closed");
            return why != "closed";
        }
        return true;
    }

    /// Publishes a frame and a sample, and sees that the client gets this very frame.
    void publish_to(WireClient& client) {
        server_->publish(feed_.next());
        server_->publish_sensors(std::vector<capture::SensorSample>(1), std::chrono::steady_clock::now());
        const auto frame = client.receive_frame(60s);
        ASSERT_TRUE(frame);
        ASSERT_EQ(frame->envelope.frame().publish_index(), published_);
        ASSERT_EQ(frame->payload, PatternFrames::expected(published_, v1::DISPARITY, 0, 0, 64, 48));
        ++published_;
    }

    void expect_clients(WireClient& asking, int count) {
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        int found = status(asking).clients_size();
        while (found != count && std::chrono::steady_clock::now() < deadline) {
            found = status(asking).clients_size();
        }
        EXPECT_EQ(found, count);
    }

    static v1::Envelope frames_and_sensors() {
        v1::Envelope wanted = subscription({v1::DISPARITY});
        wanted.mutable_subscribe()->set_sensors(true);
        return wanted;
    }

    CertificateFolder files_;
    std::uint64_t published_ = 0;
};

TEST_F(TlsPhasesTest, BytesThatAreNoTlsEndTheirOwnConnectionOnly) {
    start_with_tls();
    TlsWireClient reader = enter();
    subscribe(reader, frames_and_sensors());
    WireClient stranger("tcp" + tcp_.substr(3));
    for (int i = 0; i < 10; ++i) {  // the server has taken the stranger in, and frames reach all
        publish_to(reader);
    }
    ASSERT_TRUE(stranger.send_bytes(std::array<std::uint8_t, 2>{'X', 'X'}));
    EXPECT_THAT(stranger.receive_error(60s), HasSubstr("tls:HOST:PORT"));
    EXPECT_TRUE(stranger.is_closed(60s));
    publish_to(reader);
}

TEST_F(TlsPhasesTest, AHandshakeThatWaitsForItsTurnBeginsInItsTurn) {
    // More than may shake hands at once. Those that wait are many intervals late if a frame begins their handshake
    // early: its turn would never come.
    constexpr int clients = 40;
    files_.make({.common_name = "guest"});
    start_with_tls(true);
    TlsWireClient reader = enter("guest");
    subscribe(reader, frames_and_sensors());
    std::latch together(clients);
    std::atomic<int> arrived{0};
    std::vector<std::jthread> threads;
    for (int i = 0; i < clients; ++i) {
        threads.emplace_back([&] {
            together.arrive_and_wait();
            int attempts = 1;
            while (!comes_in("guest") && attempts < 20) {
                ++attempts;
            }
            EXPECT_LT(attempts, 20);
            ++arrived;
        });
    }
    while (arrived < clients) {
        publish_to(reader);
    }
    threads.clear();
    expect_clients(reader, 1);
}

TEST_F(TlsPhasesTest, StrangersInEveryPhaseHarmNobody) {
    config_.access.tokens = {{known_token}, {}};
    config_.handshake_interval = 1ms;  // some wait for their turn
    config_.idle_timeout = 80ms;       // all are watched, every 20 ms
    start_with_tls();
    TlsWireClient reader = enter();
    subscribe(reader, frames_and_sensors());
    const proto::TlsContext context = proto::make_client_tls(files_.client());
    std::mt19937 chance(1);  // NOLINT(cert-msc51-cpp): the same every time
    std::vector<std::unique_ptr<Stranger>> here;
    constexpr std::size_t most_here = 56;  // there are 48 places
    int let_in = 0;
    for (int left = strangers(); left > 0 || !here.empty();) {
        for (; left > 0 && here.size() < most_here; --left) {
            const std::string token = chance() % 8 == 0 ? "fedcba9876543210" : known_token;
            here.push_back(std::make_unique<Stranger>(tcp_, context, token, chance));
        }
        std::erase_if(here, [&](const auto& stranger) {
            const bool stays = chance() % 4 != 0 || stranger->step();
            let_in += !stays && stranger->was_let_in() ? 1 : 0;
            return !stays;
        });
        if (chance() % 16 == 0) {
            server_->reconfigure(config_);
        }
        if (chance() % 16 == 0) {
            server_->set_layout(feed_.layout());
        }
        ASSERT_NO_FATAL_FAILURE(publish_to(reader));
    }
    EXPECT_GT(let_in, 0) << "the walk ends too early";
    expect_clients(reader, 1);
}

}  // namespace

}  // namespace disparityd::test
