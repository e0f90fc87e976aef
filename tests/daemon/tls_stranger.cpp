// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/tls_stranger.h"

#include <algorithm>
#include <array>

#include <fcntl.h>
#include <sys/socket.h>

#include "proto/framing.h"

namespace disparityd::test {

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

}  // namespace disparityd::test
