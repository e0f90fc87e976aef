// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/http_session.h"

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "bridges/web/http/multipart_link.h"
#include "bridges/web/http/sessions.h"
#include "bridges/web/http/websocket_link.h"

namespace disparityd::web {
namespace {

/// Takes what said which daemon is meant from a request's target.
void take_prefix(Request& request, std::size_t bytes) {
    const std::string target(request.target().data() + bytes, request.target().size() - bytes);
    if (bytes > 0) {
        request.target(target.starts_with('/') ? target : '/' + target);
    }
}

}  // namespace

void HttpSession::start() {
    boost::beast::get_lowest_layer(stream_).expires_after(patience);
    stream_.shake_hands([self = shared_from_this()](Error error) {
        if (!error) {
            self->read();
        }
    });
}

void HttpSession::read() {
    answering_ = false;
    writing_since_.reset();
    load_.reset();
    parser_.emplace();
    parser_->header_limit(most_head);
    parser_->body_limit(most_body);
    boost::beast::get_lowest_layer(stream_).expires_after(patience);
    boost::beast::http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](Error error, std::size_t) {
        if (!error) {
            self->on_request();
            return;
        }
        // What is no HTTP is not worth an answer.
        self->drop();
    });
}

void HttpSession::on_request() {
    answering_ = true;
    Request whole = parser_->release();
    const Destination to = site_.daemons.destination(path_of(whole));
    take_prefix(whole, to.prefix);
    const auto request = std::make_shared<const Request>(std::move(whole));
    ++site_.parts.counters.requests;
    if (refuse_guess(*request) || upgrade(*request, to.place) || stream(*request, to.place)) {
        return;
    }
    // An answer may take as long as the daemon needs to close a recording.
    boost::beast::get_lowest_layer(stream_).expires_never();
    site_.routes.respond(*request, sender_, *to.handler, [self = shared_from_this(), request](Response response) {
        if (response.result_int() >= 400) {
            ++self->site_.parts.counters.refused;
        }
        self->write(std::move(response));
    });
}

void HttpSession::write(Response response) {
    const auto kept = std::make_shared<Response>(std::move(response));
    constexpr std::size_t least_bytes_per_second = 65536;
    writing_since_ = std::chrono::steady_clock::now();
    load_ = site_.parts.outgoing.hold(kept->body().size(), *writing_since_, [weak = weak_from_this()] {
        if (const auto self = weak.lock()) {
            self->drop();
        }
    });
    boost::beast::get_lowest_layer(stream_).expires_after(
        patience + std::chrono::seconds(kept->body().size() / least_bytes_per_second));
    boost::beast::http::async_write(stream_, *kept, [self = shared_from_this(), kept](Error error, std::size_t) {
        std::string().swap(kept->body());  // before it counts no more: the memory is free then
        self->load_.reset();
        if (error || kept->need_eof()) {
            self->drop();
        } else {
            self->read();
        }
    });
}

/// Answers after a while, and ends the connection. The answer need not have gone: its place may be given to another.
void HttpSession::refuse_late(Response response) {
    constexpr std::chrono::seconds pause{1};
    refusing_ = true;
    ++site_.parts.counters.refused;
    boost::beast::get_lowest_layer(stream_).expires_never();
    response.keep_alive(false);
    const auto timer = std::make_shared<boost::asio::steady_timer>(site_.parts.network, pause);
    timer->async_wait([self = shared_from_this(), timer, kept = std::make_shared<Response>(std::move(response))](
                          Error) { self->write(std::move(*kept)); });
}

/// Looks at the token that a request brings. A right one passes, whatever its sender or others have sent before: many
/// visitors may share an address. A wrong one counts, and one too many is answered late. Returns whether the request
/// has been dealt with. A cookie is no token; what a page of another server sends does not count.
bool HttpSession::refuse_guess(const Request& request) {
    constexpr std::string_view bearer = "Bearer ";
    const Visitor visitor = visitor_of(request);
    bool wrong = false;
    if (visitor.authorization.starts_with(bearer)) {  // other schemes are a proxy's affair
        wrong = !site_.access.knows(visitor.authorization.substr(bearer.size()));
    }
    if (const std::optional<std::string> token = log_in_token(request)) {
        wrong = wrong || !site_.access.knows(*token);
    }
    if (!wrong || !site_.access.needs_token() || !site_.access.refuses(visitor).empty() ||
        !site_.guesses.count(sender_, std::chrono::steady_clock::now())) {
        return false;
    }
    refuse_late(error_response(request, boost::beast::http::status::too_many_requests,
                               "too many wrong tokens have come: this one is wrong, too; try again in a minute"));
    return true;
}

void HttpSession::refuse(Response response) {
    ++site_.parts.counters.refused;
    write(std::move(response));
}

/// Makes this connection's place one of a stream. Answers where there is none, and returns false.
bool HttpSession::promote(const Request& request, Right right) {
    if (site_.connections.promote(this, right == Right::control ? Stay::controller : Stay::viewer)) {
        return true;
    }
    refuse(error_response(request, boost::beast::http::status::service_unavailable,
                          "all " + std::to_string(site_.connections.places_for_viewers()) +
                              " places for pages and streams are taken; close one, or start disparity-web with a "
                              "higher --max-connections"));
    return false;
}

/// Makes the connection a WebSocket when the request asks for one. Returns whether it has been dealt with.
bool HttpSession::upgrade(const Request& request, const Workplace* place) {
    if (!boost::beast::websocket::is_upgrade(request)) {
        return false;
    }
    if (place == nullptr) {
        refuse(error_response(request, boost::beast::http::status::not_found,
                              "a WebSocket is of one daemon that was found: its path is /i/NAME/, and /api/instances "
                              "lists the names"));
        return true;
    }
    WebSocketChoice choice = choose_websocket(request, *place, site_.access, sender_);
    if (choice.handler == nullptr) {
        refuse(std::move(choice.refusal));
    } else if (promote(request, choice.right)) {
        const auto link =
            std::make_shared<WebSocketLink>(std::move(stream_), std::move(choice.handler), site_.parts.outgoing);
        site_.connections.hand_over(this, link);
        link->accept(request, choice.protocol);
    }
    return true;
}

/// Makes the connection an MJPEG stream when the request asks for one. Returns whether it has been dealt with.
bool HttpSession::stream(const Request& request, const Workplace* place) {
    if (place == nullptr || path_of(request) != "/stream.mjpg" || request.method() != boost::beast::http::verb::get) {
        return false;
    }
    StreamChoice choice = choose_stream(request, *place, site_.access, sender_);
    if (choice.handler == nullptr) {
        refuse(std::move(choice.refusal));
    } else if (promote(request, choice.right)) {
        const auto link =
            std::make_shared<MultipartLink>(std::move(stream_), std::move(choice.handler), site_.parts.outgoing);
        site_.connections.hand_over(this, link);
        link->start(choice.head);
    }
    return true;
}

}  // namespace disparityd::web
