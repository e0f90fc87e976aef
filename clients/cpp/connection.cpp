// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/connection.h"

#include <algorithm>
#include <exception>
#include <fstream>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include <sys/stat.h>

#include "proto/monotonic_clock.h"
#include "proto/text.h"

namespace disparity {
namespace {

/// Reads a token: of the first line that is neither empty nor begins with #, the last word. A line of the daemon's
/// file, "view TOKEN", will do. An empty path gives an empty token. Throws std::invalid_argument with one line when the
/// file cannot be read or holds none, and when every user may read it.
std::string read_token(const std::string& path) {
    if (path.empty()) {
        return {};
    }
    struct stat facts {};
    const bool found = ::stat(path.c_str(), &facts) == 0;
    if (found && !S_ISREG(facts.st_mode) && !S_ISDIR(facts.st_mode)) {  // a pipe would be waited for
        throw std::invalid_argument(path + ": the file with the token is not a regular file, allowed: a regular file");
    }
    std::ifstream file(path);
    if (!found || !file || S_ISDIR(facts.st_mode)) {
        throw std::invalid_argument(path + ": the file with the token cannot be read");
    }
    if ((facts.st_mode & (S_IROTH | S_IWOTH)) != 0) {
        throw std::invalid_argument(path + ": every user may read the token; chmod o-rw " + path);
    }
    constexpr const char* blanks = " \t\r";
    std::string line;
    while (std::getline(file, line)) {
        line.erase(line.find_last_not_of(blanks) + 1);
        if (!line.empty() && line.front() != '#') {
            return line.substr(line.find_last_of(blanks) + 1);
        }
    }
    throw std::invalid_argument(path + ": holds no token; write one into its first line");
}

namespace proto = disparityd::proto;
namespace v1 = disparityd::v1;
using std::chrono::milliseconds;

/// A subscription is small: only a daemon that hangs takes this long to accept it.
constexpr milliseconds send_timeout{5000};

/// An attempt to connect again takes no longer: a packet that a dead link has swallowed is sent again only after longer
/// and longer pauses, a new attempt begins at once.
constexpr milliseconds attempt_timeout{1000};
constexpr milliseconds tls_attempt_timeout{2000};

/// The daemon must answer the Hello of a new connection within this time, over any number of calls.
constexpr milliseconds hello_timeout{2500};

/// Passes between two attempts to connect again.
constexpr milliseconds reconnect_interval{100};

/// A caller that waits looks at the socket at least this often.
constexpr milliseconds look_interval{50};

constexpr const char* no_answer = "no answer to hello in time: the daemon hangs, or another program listens there";

std::uint64_t random_id() {
    std::random_device device;
    const std::uint64_t id = std::uint64_t{device()} << 32U | device();
    return id == 0 ? 1 : id;
}

std::string seconds_text(std::int64_t ns) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f s", static_cast<double>(ns) / 1e9);
    return text;
}

}  // namespace

Connection::Connection(const std::string& address, ConnectOptions options, const std::string& name,
                       milliseconds timeout)
    : address_(address), options_(std::move(options)), name_(name), client_id_(random_id()) {
    const Deadline deadline = after(timeout);
    connect(deadline, deadline);
    if (!greeted(deadline)) {
        fail(no_answer);
    }
}

/// Opens another connection and sends Hello. The daemon must answer until `greeting`.
void Connection::connect(Deadline deadline, Deadline greeting) {
    stream_ = std::make_unique<MessageStream>(address_, deadline, options_);
    greeting_ = greeting;
    by_credit_ = false;
    clock_.forget();
    v1::Envelope envelope;
    v1::Hello& hello = *envelope.mutable_hello();
    hello.set_token(token());
    hello.set_protocol_version(proto::protocol_version);
    hello.set_client_name(name_);
    hello.set_client_id(client_id_);
    hello_ns_ = proto::monotonic_ns();
    send(envelope, greeting);
}

/// Returns the token for this connection; empty over a Unix socket, where the daemon needs none.
std::string Connection::token() const {
    if (address_.starts_with("unix:")) {
        return {};
    }
    std::string token = options_.token.empty() ? read_token(options_.token_file) : options_.token;
    if (!token.empty() && !stream_->is_private()) {
        throw std::invalid_argument(address_ +
                                    ": a token would be sent unencrypted, allowed: over tls:HOST:PORT, or to this "
                                    "machine");
    }
    return token;
}

/// Waits for the daemon's answer to Hello. Returns false when it has not come by the deadline and may still come.
bool Connection::greeted(Deadline deadline) {
    do {
        const auto outcome = receive(std::min(deadline, greeting_));
        if (outcome == Outcome::timeout) {
            if (std::chrono::steady_clock::now() >= greeting_) {
                fail(no_answer);
            }
            return false;
        }
        if (outcome == Outcome::closed) {
            fail("the connection has ended before hello was answered" + ended_by_);
        }
    } while (!envelope().has_welcome());
    const std::int64_t now = proto::monotonic_ns();
    const v1::Welcome& welcome = envelope().welcome();
    if (welcome.protocol_version() != proto::protocol_version) {
        fail<Refused>("it speaks version " + std::to_string(welcome.protocol_version()) +
                      " of the protocol, this program version " + std::to_string(proto::protocol_version) +
                      ": use the client library that came with the daemon");
    }
    welcome_ = welcome.SerializeAsString();
    if (welcome.monotonic_ns() != 0 && welcome.monotonic_ns() == sane_ns(welcome.monotonic_ns())) {
        by_credit_ = true;
        clock_.add(hello_ns_, welcome.monotonic_ns(), now);
        liveness_ = {};
        keep_clock();
    }
    return true;
}

bool Connection::come_back(Deadline deadline) {
    std::exception_ptr refusal;
    while (true) {
        try {
            if (!stream_) {
                const auto limit = address_.starts_with("tls:") ? tls_attempt_timeout : attempt_timeout;
                connect(std::min(deadline, after(limit)), after(hello_timeout));
            }
            if (greeted(deadline)) {
                lost_ = false;
                unanswered_ = false;
                send_subscription();
                return true;
            }
            break;
        } catch (const std::runtime_error& error) {
            end(error.what());
            refusal = dynamic_cast<const Refused*>(&error) != nullptr ? std::current_exception() : nullptr;
        } catch (const std::invalid_argument& error) {  // a file that was right before
            end(error.what());
            refusal = std::make_exception_ptr(Refused(error.what()));
        }
        const Deadline next = std::chrono::steady_clock::now() + reconnect_interval;
        std::this_thread::sleep_until(std::min(deadline, next));
        if (next >= deadline) {
            break;
        }
    }
    if (refusal) {
        std::rethrow_exception(refusal);
    }
    return false;
}

void Connection::end(const std::string& why) {
    lost_ = true;
    stream_.reset();
    why_gone_ = why;
}

void Connection::subscribe(const v1::Envelope& subscription) {
    subscription_ = subscription;
    if (!lost_) {
        send_subscription();
    }
}

/// Where it cannot be sent, the next read reports why, or sends it over another connection.
void Connection::send_subscription() {
    if (subscription_) {
        subscription_->mutable_subscribe()->set_by_credit(by_credit_);
        static_cast<void>(stream_->send(*subscription_, after(send_timeout)));
    }
}

void Connection::give_credit(std::uint32_t frames) {
    if (frames > 0 && stream_) {  // it may have ended behind the frame that is given
        v1::Envelope envelope;
        envelope.mutable_ready()->set_frames(frames);
        static_cast<void>(stream_->send(envelope, after(milliseconds(0))));  // the next look at the socket tells
    }
}

void Connection::send(const v1::Envelope& envelope, Deadline deadline) {
    if (stream_->send(envelope, deadline) != Outcome::done) {
        // An Error that arrived before the connection ended explains more than a broken connection.
        while (receive(after(milliseconds(0))) == Outcome::done) {
        }
        fail("the connection has ended");
    }
}

Connection::Outcome Connection::receive(Deadline deadline) {
    Outcome outcome{};
    do {
        try {
            outcome = stream_->receive(deadline);
        } catch (const std::invalid_argument& error) {
            fail(std::string("broke the protocol: ") + error.what());
        }
        if (outcome == Outcome::done && envelope().has_pong()) {
            take_pong();
        }
    } while (outcome == Outcome::done && envelope().has_pong());
    if (outcome == Outcome::done && envelope().has_error()) {
        fail<Refused>(proto::to_printable_utf8(envelope().error().message()));
    }
    if (outcome == Outcome::closed) {
        ended_by_ = stream_->why_closed().empty() ? "" : ": " + stream_->why_closed();
        end("disparityd at " + address_ + ": the connection has ended" + ended_by_);
    }
    return outcome;
}

Connection::Outcome Connection::listen(Deadline deadline, std::int64_t interval_ns) {
    keep_clock();
    while (true) {
        const Outcome outcome = receive(std::min(deadline, after(look_interval)));
        if (outcome != Outcome::timeout) {
            return outcome;
        }
        if (by_credit_ && !answers(interval_ns)) {
            return Outcome::closed;
        }
        if (std::chrono::steady_clock::now() >= deadline) {
            return outcome;
        }
    }
}

/// Asks the daemon whether it is there, and for its clock, when that is due.
void Connection::ask(std::int64_t now_ns, std::int64_t interval_ns) {
    if (!liveness_.asks(now_ns, stream_->heard_ns(), interval_ns)) {
        return;
    }
    v1::Envelope envelope;
    envelope.mutable_ping()->set_client_ns(now_ns);
    static_cast<void>(stream_->send(envelope, after(milliseconds(0))));
}

/// An answer to another question, or one that is no time, is left alone.
void Connection::take_pong() {
    const v1::Pong& pong = envelope().pong();
    if (pong.client_ns() != liveness_.asked_ns() || pong.monotonic_ns() != sane_ns(pong.monotonic_ns())) {
        return;
    }
    clock_.add(pong.client_ns(), pong.monotonic_ns(), proto::monotonic_ns());
}

/// The socket has just been found empty. Returns whether the daemon may still be there.
bool Connection::answers(std::int64_t interval_ns) {
    const std::int64_t now = proto::monotonic_ns();
    const std::int64_t heard = stream_->heard_ns();
    if (liveness_.is_gone(now, heard)) {
        end("disparityd at " + address_ + ": no answer from the daemon for " + seconds_text(now - heard) +
            ": connecting anew");
        unanswered_ = true;
        return false;
    }
    ask(now, interval_ns);
    return true;
}

void Connection::keep_clock() {
    if (stream_ && by_credit_) {
        ask(proto::monotonic_ns(), Liveness::longest_interval);
    }
}

}  // namespace disparity
