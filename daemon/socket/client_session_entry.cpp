// SPDX-License-Identifier: Apache-2.0
//
// How a client comes in: the TLS handshake, the time until its Hello, its token, and what it may do.
#include <utility>

#include <fmt/format.h>

#include "daemon/socket/client_session.h"
#include "daemon/socket/clients.h"

namespace disparityd::daemon {
namespace {

using boost::system::error_code;

constexpr std::chrono::seconds hello_timeout{5};
/// Passes before a wrong token is told: guessing is slow, and a right token waits for nobody.
constexpr std::chrono::seconds pause_after_wrong_token{1};

}  // namespace

void ClientSession::start(std::chrono::nanoseconds wait) {
    deadline_.expires_after(hello_timeout);
    deadline_.async_wait(handler([](ClientSession& self, error_code error) {
        if (error || self.greeted_) {
            return;
        }
        if (!self.is_open()) {
            self.close(fmt::format("no TLS handshake within {} s", hello_timeout.count()));
        } else {
            self.send_error(fmt::format("no Hello within {} s: the first message must be Hello", hello_timeout.count()),
                            true);
        }
    }));
    shake_hands_after(wait, [](ClientSession& self) { self.read_length(); });
}

void ClientSession::refuse(const std::string& why, std::chrono::nanoseconds wait) {
    deadline_.expires_after(hello_timeout);
    deadline_.async_wait(handler([](ClientSession& self, error_code error) {
        if (!error) {
            self.close("refused, and does not read why");
        }
    }));
    shake_hands_after(wait, [why](ClientSession& self) { self.send_error(why, true); });
}

/// Calls then(self) after the TLS handshake, which begins after `wait`; at once without TLS.
template <typename Then>
void ClientSession::shake_hands_after(std::chrono::nanoseconds wait, Then then) {
    if (!stream_.encrypted()) {
        phase_ = Phase::open;
        then(*this);
        return;
    }
    if (wait.count() == 0) {
        shake_hands(std::move(then));
        return;
    }
    turn_timer_.expires_after(wait);
    turn_timer_.async_wait(handler([then = std::move(then)](ClientSession& self, error_code error) mutable {
        if (!error && self.phase_ == Phase::waiting) {
            self.shake_hands(std::move(then));
        }
    }));
}

template <typename Then>
void ClientSession::shake_hands(Then then) {
    phase_ = Phase::handshake;
    stream_.async_handshake(handler([then = std::move(then)](ClientSession& self, error_code error) {
        if (self.phase_ != Phase::handshake) {
            return;  // it was closed meanwhile
        }
        if (error) {
            self.handshake_failed(error);
            return;
        }
        self.phase_ = Phase::open;
        self.peer_.certificate = self.stream_.certificate();
        then(self);
    }));
}

void ClientSession::handshake_failed(const error_code& error) {
    if (error == ClientStream::no_tls()) {
        peer_.encrypted = false;
        phase_ = Phase::open;
        send_error(
            "this port speaks TLS only: connect to tls:HOST:PORT, with --authority FILE where the daemon's certificate "
            "is signed by an authority of your own",
            true);
        return;
    }
    clients_.log().errors.write(LogLevel::warning,
                                fmt::format("{}: closed: no TLS handshake: {}", label(), stream_.reason(error)));
    phase_ = Phase::leaving;
    close_later();
    end_output();  // after OpenSSL's alert, which tells the client why
}

bool ClientSession::make_place() noexcept {
    if (greeted_) {
        return false;
    }
    close("closed: it had not said hello, and another client needs its place");
    return true;
}

void ClientSession::access_changed() {
    if (!greeted_ || !is_open()) {
        return;
    }
    if (const std::string why = why_refused(token_); !why.empty()) {
        send_error("since the daemon was reconfigured: " + why, true);
    }
}

/// Returns why the client may not look; empty: it may. The rules may be newer than the handshake.
std::string ClientSession::why_refused(const std::string& token) const {
    const ClientRules& rules = clients_.rules();
    if (rules.access.right_of(peer_, token) == base::Right::none) {
        return rules.access.why_not_view(peer_, token);
    }
    if (stream_.encrypted() && rules.access.certificates && !stream_.would_be_taken_by(rules.tls)) {
        return "the certificate of this client is revoked, or of no authority in the file of [socket] client_authority";
    }
    return {};
}

/// Returns whether the client may look; else sends an Error, which a wrong token waits for.
bool ClientSession::admit(const std::string& token) {
    const std::string why = why_refused(token);
    if (why.empty()) {
        token_ = token;
        return true;
    }
    if (peer_.local || token.empty()) {
        send_error(why, true);
    } else {
        refuse_late(why);
    }
    return false;
}

void ClientSession::refuse_late(const std::string& why) {
    deadline_.expires_after(pause_after_wrong_token);
    // Nothing is read meanwhile, as before any answer.
    deadline_.async_wait(handler([why, question = ask()](ClientSession& self, error_code error) {
        if (!error) {
            self.send_error(why, true);
        }
    }));
}

/// Returns whether the client may do that; sends an Error if not.
bool ClientSession::may_control(std::string_view what) {
    const ClientAccess& access = clients_.rules().access;
    if (access.right_of(peer_, token_) == base::Right::control) {
        return true;
    }
    send_error(fmt::format("{}: {}", what, access.why_not_control(peer_)), false);
    return false;
}

}  // namespace disparityd::daemon
