// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <boost/beast/http.hpp>

#include "bridges/web/daemon/daemon_control.h"
#include "bridges/web/http/access.h"
#include "bridges/web/live/live_session.h"

namespace disparityd::web {

using Request = boost::beast::http::request<boost::beast::http::string_body>;
using Response = boost::beast::http::response<boost::beast::http::string_body>;

/// Answers HTTP requests, all but WebSockets and the MJPEG stream. The network's thread owns it.
class Routes {
public:
    Routes(const Workplace& workplace, Access& access, DaemonControl& control)
        : place_(workplace), access_(access), control_(control) {}

    /// Calls `answer` once, in the network's thread: at once or later. `peer`: the visitor's address.
    using Answer = std::function<void(Response)>;
    void respond(const Request& request, const std::string& peer, const Answer& answer);

private:
    struct Asked;
    void view(const Asked& asked);
    void control(const Asked& asked);
    void session(const Asked& asked);
    void refuse_token(const Asked& asked);
    void snapshot(const Asked& asked);
    void make_snapshot(const std::shared_ptr<const Request>& request, const std::string& peer, const Answer& answer,
                       const std::string& type, std::function<std::string()> make);
    void camera(const Asked& asked);
    void recording(const Asked& asked);
    std::function<void(ControlAnswer)> to_answer(const Asked& asked);

    Workplace place_;
    Access& access_;
    DaemonControl& control_;
    int requests_under_way_ = 0;  ///< to the daemon
    int snapshots_under_way_ = 0;
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
