// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/sessions.h"

#include <charconv>
#include <cmath>
#include <optional>

#include <boost/beast/http.hpp>

#include "base/number_text.h"
#include "bridges/web/live/foxglove_link.h"
#include "bridges/web/live/mjpeg_session.h"

namespace disparityd::web {

namespace http = boost::beast::http;

namespace {

constexpr const char* live_protocol = "disparityd.live.v1";

/// Returns the reason for a refusal, or nothing.
std::optional<Response> refused(const Request& request, const Access& access) {
    const Visitor visitor = visitor_of(request);
    if (const std::string why = access.refuses(visitor); !why.empty()) {
        return error_response(request, http::status::forbidden, why);
    }
    if (access.right_of(visitor) < Right::view) {
        return error_response(request, http::status::unauthorized,
                              "a token is needed; the page asks for it, others send it as a bearer token");
    }
    return std::nullopt;
}

bool offers(const Request& request, const std::string& protocol) {
    const auto header = request[http::field::sec_websocket_protocol];
    return http::token_list(header).exists(protocol);
}

/// Returns the first of Foxglove's names that the client offers; "" = none.
std::string foxglove_protocol(const Request& request) {
    for (const auto& offered : http::token_list(request[http::field::sec_websocket_protocol])) {
        for (const std::string_view known : foxglove::subprotocols) {
            if (std::string_view(offered.data(), offered.size()) == known) {
                return std::string(known);
            }
        }
    }
    return {};
}

/// Returns the number in a query: `usual` where there is none, nothing where it is none or out of its limits.
std::optional<int> number_of(const Request& request, const std::string& key, int most, int usual) {
    const std::string text = query_of(request, key);
    if (text.empty()) {
        return usual;
    }
    int number = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, number);
    return error == std::errc() && stop == end && number >= 0 && number <= most ? std::optional<int>(number)
                                                                                : std::nullopt;
}

/// Returns the frames per second that a stream has at most, for a header; "all" while the daemon has told no rate.
std::string rate_told(int asked, const DaemonState& state) {
    const double captured = state.status ? state.status->rate() : 0;
    const double rate = asked > 0 && (captured <= 0 || asked < captured) ? asked : captured;
    return rate > 0 ? base::number_text(std::round(rate * 10) / 10) : "all";
}

}  // namespace

WebSocketChoice choose_websocket(const Request& request, const Workplace& workplace, const Access& access,
                                 const std::string& peer) {
    WebSocketChoice choice;
    choice.right = access.right_of(visitor_of(request));
    if (auto refusal = refused(request, access)) {
        choice.refusal = std::move(*refusal);
    } else if (offers(request, live_protocol)) {
        choice.protocol = live_protocol;
        choice.handler = std::make_shared<LiveSession>(workplace, peer);
    } else if (const std::string protocol = foxglove_protocol(request); !protocol.empty()) {
        choice.protocol = protocol;
        choice.handler = std::make_shared<FoxgloveLink>(workplace, peer);
    } else {
        choice.refusal =
            error_response(request, http::status::bad_request,
                           "allowed subprotocols: disparityd.live.v1, foxglove.sdk.v1, foxglove.websocket.v1");
    }
    return choice;
}

StreamChoice choose_stream(const Request& request, const Workplace& workplace, const Access& access,
                           const std::string& peer) {
    StreamChoice choice;
    choice.right = access.right_of(visitor_of(request));
    if (auto refusal = refused(request, access)) {
        choice.refusal = std::move(*refusal);
        return choice;
    }
    const std::string name = query_of(request, "image");
    const std::optional<Image> image = image_of(name.empty() ? "disparity" : name);
    const std::optional<int> width = number_of(request, "width", 16384, 0);
    const std::optional<int> rate = number_of(request, "rate", 1000, 0);
    if (!image || !width || !rate) {
        choice.refusal = error_response(request, http::status::bad_request,
                                        "allowed: image=" + image_names() + "; width=0 to 16384; rate=0 to 1000");
        return choice;
    }
    if (const std::string why = why_not_served(workplace.hub.state(), product_of(*image)); !why.empty()) {
        choice.refusal = error_response(request, http::status::not_found, why);
        return choice;
    }
    constexpr int quality = 80;
    choice.handler = std::make_shared<MjpegSession>(
        workplace, peer, ImageView{*image, Encoding::jpeg, *width, quality, std::nullopt}, *rate);
    choice.head = std::string("HTTP/1.1 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=") +
                  MjpegSession::boundary + "\r\nX-Max-Rate: " + rate_told(*rate, workplace.hub.state()) +
                  "\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nCross-Origin-Resource-Policy: "
                  "same-origin\r\nConnection: close\r\n\r\n";
    return choice;
}

}  // namespace disparityd::web
