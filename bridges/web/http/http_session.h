// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include "bridges/web/http/connections.h"
#include "bridges/web/http/destination.h"
#include "bridges/web/http/peer_stream.h"
#include "bridges/web/http/routes.h"
#include "bridges/web/http/token_guesses.h"

namespace disparityd::web {

/// What all connections share.
struct Site {
    ServerParts parts;
    Access& access;
    Routes& routes;
    ServedDaemons& daemons;
    Connections& connections;
    TokenGuesses& guesses;
};

/// One HTTP connection, until it ends or becomes a WebSocket or a stream.
/// The operations under way keep it alive.
class HttpSession : public Connection, public std::enable_shared_from_this<HttpSession> {
public:
    /// `sender`: the visitor's address, as sender_of() names it.
    HttpSession(PeerStream&& stream, const Site& site, std::string sender)
        : stream_(std::move(stream)), site_(site), sender_(std::move(sender)) {}

    void start();
    void drop() override { boost::beast::get_lowest_layer(stream_).close(); }
    /// A peer that does not read its answer holds a place, too, and one that waits for being refused.
    bool idle() const override {
        return !answering_ || refusing_ ||
               (writing_since_ && std::chrono::steady_clock::now() - *writing_since_ > slow_reader);
    }

private:
    using Error = boost::system::error_code;
    /// A whole request must come within this time, also the first byte of the next one.
    static constexpr std::chrono::seconds patience{20};
    static constexpr std::chrono::seconds slow_reader{2};
    static constexpr std::size_t most_head = 8192;
    static constexpr std::size_t most_body = 16384;

    void read();
    void on_request();
    void write(Response response);
    void refuse_late(Response response);
    bool refuse_guess(const Request& request);
    bool promote(const Request& request, Right right);
    bool upgrade(const Request& request, const Workplace* place);
    bool stream(const Request& request, const Workplace* place);
    void refuse(Response response);

    PeerStream stream_;
    Site site_;
    std::string sender_;
    boost::beast::flat_buffer buffer_{most_head + most_body};
    std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> parser_;
    bool answering_ = false;
    bool refusing_ = false;
    std::optional<std::chrono::steady_clock::time_point> writing_since_;  ///< when the answer was ready
    std::unique_ptr<Outgoing::Load> load_;                                ///< the answer that is being written
};

}  // namespace disparityd::web
