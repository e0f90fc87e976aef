// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/beast/http.hpp>

#include "bridges/web/http/access.h"

namespace disparityd::web {

using Request = boost::beast::http::request<boost::beast::http::string_body>;
using Response = boost::beast::http::response<boost::beast::http::string_body>;

/// Called once, in the network's thread: at once or later.
using Answer = std::function<void(Response)>;

/// A request that is being answered.
struct Asked {
    const Request& request;
    const std::string& peer;  ///< the visitor's address
    const Answer& answer;
    std::string path;
    Right right;

    void json(const std::string& text) const;
    void metrics(const std::string& text) const;
    void error(boost::beast::http::status status, const std::string& line) const;
    bool is(boost::beast::http::verb verb) const;  ///< HEAD is GET, too
};

/// Answers what is asked about something: a daemon, or all of them. The network's thread calls it.
class Handler {
public:
    virtual ~Handler() = default;
    /// The sender may look.
    virtual void view(const Asked& asked) = 0;
    /// Returns one line for /healthz, "" where all is well.
    virtual std::string trouble() const = 0;
    /// The page at "/", as page_file() knows it.
    virtual std::string_view page() const = 0;
};

/// Answers HTTP requests, all but WebSockets and the MJPEG stream: looks who asks, answers what needs no daemon, and
/// hands the rest to a handler. The network's thread owns it.
class Routes {
public:
    Routes(boost::asio::io_context& network, Access& access) : network_(network), access_(access) {}

    /// `peer`: the visitor's address. `handler` lives until the answer.
    void respond(const Request& request, const std::string& peer, Handler& handler, const Answer& answer);

private:
    void session(const Asked& asked);
    void refuse_token(const Asked& asked);

    boost::asio::io_context& network_;
    Access& access_;
};

/// Returns what a request tells of its sender. It refers to the request.
Visitor visitor_of(const Request& request);

/// Returns the token of a request to log in; nothing when it is another request or has none.
std::optional<std::string> log_in_token(const Request& request);

/// Returns the path of the target, without the query; the value of a query's key, "" where there is none.
std::string path_of(const Request& request);
std::string query_of(const Request& request, const std::string& key);

/// Returns a response with the headers that each has. `error_response` has one line as {"error": line}.
Response make_response(const Request& request, boost::beast::http::status status, const std::string& type,
                       std::string body);
Response error_response(const Request& request, boost::beast::http::status status, const std::string& line);

}  // namespace disparityd::web
