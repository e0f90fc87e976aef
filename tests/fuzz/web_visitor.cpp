// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/web_visitor.h"

#include <array>
#include <optional>

#include <boost/asio/local/stream_protocol.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "bridges/web/http/all_daemons.h"
#include "bridges/web/http/http_session.h"
#include "tests/bridges/ros_messages/message_frames.h"
#include "tests/fuzz/outcome.h"

namespace disparityd::fuzz {

using boost::asio::local::stream_protocol;

namespace {

constexpr std::size_t most_kept = 65536;

web::AccessRules rules() {
    web::AccessRules rules;
    rules.anybody_controls = true;
    rules.tokens = {{"0123456789abcdef"}, {}};
    return rules;
}

std::shared_ptr<web::LiveFrame> frame() {
    auto live = std::make_shared<web::LiveFrame>();
    live->frame = test::grey_frame();
    live->received = std::chrono::steady_clock::now();
    return live;
}

web::DaemonState state() {
    web::DaemonState state;
    state.there = true;
    state.why.clear();
    state.status = std::make_shared<v1::Status>(test::daemon_status());
    for (const auto& plane : test::grey_frame().planes) {
        state.products.push_back(plane.product);
    }
    return state;
}

/// A daemon that the fuzzer plays, alone or below "/i/NAME/".
class OnlyDaemon : public web::ServedDaemons {
public:
    OnlyDaemon(const web::Workplace& place, web::Handler& handler) : place_(place), handler_(handler) {}

    web::Destination destination(std::string_view path) override {
        const std::string_view name = web::daemon_in_path(path);
        return {&place_, &handler_, name.empty() ? 0 : 3 + name.size()};
    }
    void stop() override {}

private:
    const web::Workplace& place_;
    web::Handler& handler_;
};

}  // namespace

/// The parts in the order in which the server has them: the last one ends first.
class WebVisitor::Impl {
public:
    Impl() {
        hub_.on_state(state());
        std::array<int, 2> ends{};
        expect(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) == 0, "socketpair");
        visitor_ = ends[1];
        // What the server has over TCP, over a socket pair.
        web::PeerStream stream(stream_protocol::socket(network_, stream_protocol(), ends[0]));
        const auto session = std::make_shared<web::HttpSession>(
            std::move(stream), web::Site{parts_, access_, routes_, daemon_, connections_, guesses_}, "fuzz");
        expect(connections_.admit(session, "fuzz"), "no room for the only visitor");
        session->start();
    }

    ~Impl() {
        ::close(visitor_);
        network_.poll();
        control_.reset();  // its threads end, and their answers are there
        encoding_.join();
        connections_.drop_all();
        network_.poll();
    }

    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    void say(std::string_view bytes) {
        for (bool busy = true; busy;) {
            const ssize_t sent = bytes.empty() ? 0 : ::send(visitor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
            bytes.remove_prefix(sent > 0 ? static_cast<std::size_t>(sent) : 0);
            busy = network_.poll() > 0 || sent > 0;
            busy = listen() || busy;
        }
    }

    void publish() {
        hub_.on_state(state());
        hub_.on_frame(frame());
        hub_.on_sensors(test::sensor_batch());
        say("");
        encoding_.join();
        say("");
    }

    std::string take_answers() { return std::exchange(answers_, {}); }

private:
    bool listen() {
        std::array<char, 4096> bytes{};
        bool heard = false;
        for (ssize_t got = 0; (got = ::recv(visitor_, bytes.data(), bytes.size(), 0)) > 0; heard = true) {
            answers_.append(bytes.data(), static_cast<std::size_t>(got));
            answers_.erase(0, answers_.size() - std::min(answers_.size(), most_kept));
        }
        return heard;
    }

    web::Access access_{rules(), false};
    web::Outgoing outgoing_;
    boost::asio::io_context network_{1};
    web::EncodingTurns encoding_;
    web::Hub hub_{[](const web::Wants&) {}};
    web::Connections connections_{8};
    web::TokenGuesses guesses_;
    web::WebCounters counters_;
    web::ServerParts parts_{network_, encoding_, outgoing_, counters_};
    web::Workplace place_{parts_, hub_};
    std::optional<web::DaemonControl> control_{web::DaemonAddress{"unix:/nonexistent/socket"}};
    web::DaemonRoutes daemon_routes_{place_, *control_};
    OnlyDaemon daemon_{place_, daemon_routes_};
    web::Routes routes_{network_, access_};
    int visitor_ = -1;
    std::string answers_;
};

WebVisitor::WebVisitor() : impl_(std::make_unique<Impl>()) {}
WebVisitor::~WebVisitor() = default;

void WebVisitor::say(std::string_view bytes) {
    impl_->say(bytes);
}

void WebVisitor::publish() {
    impl_->publish();
}

std::string WebVisitor::take_answers() {
    return impl_->take_answers();
}

}  // namespace disparityd::fuzz
