// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/routes.h"

#include <memory>
#include <utility>

#include <boost/asio/steady_timer.hpp>

#include "bridges/web/http/page_files.h"
#include "bridges/web/http/request_body.h"
#include "bridges/web/images/colours.h"
#include "bridges/web/metrics/prometheus_text.h"
#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"
#include "proto/products.h"

namespace disparityd::web {

namespace http = boost::beast::http;
using json::Json;
using json::to_text;

namespace {

constexpr const char* session_path = "/api/session";
constexpr std::chrono::seconds pause_after_wrong_token{1};

std::string_view text_of(boost::beast::string_view text) {
    return {text.data(), text.size()};
}

std::string session_json(const Access& access, Right right) {
    return to_text(
        {{"needs_token", access.needs_token()}, {"view", right >= Right::view}, {"control", right >= Right::control}},
        -1);
}

/// Returns the table of products as a module for the page.
std::string products_script() {
    Json list = Json::array();
    for (const proto::ProductFacts& product : proto::products) {
        const auto* const value = v1::Product_descriptor()->FindValueByNumber(product.number);
        list.push_back(json::to_json(value->options().GetExtension(v1::product)));
        list.back()["name"] = product.name;
    }
    return "export const PRODUCTS = " + to_text(list, 2) + '\n';
}

/// Returns the colours of distances, red, green, blue of each from far to near, as a module for the page.
std::string turbo_script() {
    Json numbers = Json::array();
    for (const auto& [blue, green, red] : turbo()) {
        numbers.insert(numbers.end(), {red, green, blue});
    }
    return "export const TURBO = new Uint8Array(" + to_text(numbers, -1) + ")\n";
}

/// Returns the file at a path; of pages only the one that is at "/".
const PageFile* page_at(const std::string& path, std::string_view page) {
    return path == "/" ? page_file(page) : path.ends_with(".html") ? nullptr : page_file(path);
}

}  // namespace

Visitor visitor_of(const Request& request) {
    return {text_of(request[http::field::host]), text_of(request[http::field::origin]),
            text_of(request[http::field::authorization]), text_of(request[http::field::cookie])};
}

std::string path_of(const Request& request) {
    const std::string target(text_of(request.target()));
    return target.substr(0, target.find('?'));
}

std::optional<std::string> log_in_token(const Request& request) {
    if (request.method() != http::verb::post || path_of(request) != session_path) {
        return std::nullopt;
    }
    const std::optional<Json> body = body_of(request);
    return body ? std::optional<std::string>(text_in(*body, "token")) : std::nullopt;
}

std::string query_of(const Request& request, const std::string& key) {
    const std::string target(text_of(request.target()));
    std::size_t from = target.find('?');
    while (from != std::string::npos) {
        const std::size_t end = target.find('&', from + 1);
        const std::string pair = target.substr(from + 1, end == std::string::npos ? end : end - from - 1);
        if (pair.compare(0, key.size() + 1, key + '=') == 0) {
            return pair.substr(key.size() + 1);
        }
        from = end;
    }
    return {};
}

Response make_response(const Request& request, http::status status, const std::string& type, std::string body) {
    Response response(status, request.version());
    response.set(http::field::content_type, type);
    response.set(http::field::cache_control, "no-store");
    response.set("X-Content-Type-Options", "nosniff");
    response.set("Referrer-Policy", "no-referrer");
    response.set("Cross-Origin-Resource-Policy", "same-origin");
    response.set("Content-Security-Policy",
                 "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src "
                 "'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    response.keep_alive(request.keep_alive());
    response.body() = std::move(body);
    response.prepare_payload();
    if (request.method() == http::verb::head) {
        response.body().clear();
    }
    return response;
}

Response error_response(const Request& request, http::status status, const std::string& line) {
    return make_response(request, status, "application/json", to_text({{"error", line}}, -1));
}

void Asked::json(const std::string& text) const {
    answer(make_response(request, http::status::ok, "application/json", text));
}

void Asked::metrics(const std::string& text) const {
    answer(make_response(request, http::status::ok, prometheus_content_type, text));
}

void Asked::error(http::status status, const std::string& line) const {
    answer(error_response(request, status, line));
}

bool Asked::is(http::verb verb) const {
    return request.method() == verb || (verb == http::verb::get && request.method() == http::verb::head);
}

void Routes::respond(const Request& request, const std::string& peer, Handler& handler, const Answer& answer) {
    const Visitor visitor = visitor_of(request);
    const Asked asked{request, peer, answer, path_of(request), access_.right_of(visitor)};
    if (const std::string why = access_.refuses(visitor); !why.empty()) {
        asked.error(http::status::forbidden, why);
    } else if (asked.path == "/healthz" && asked.is(http::verb::get)) {
        const std::string trouble = handler.trouble();
        answer(make_response(request, trouble.empty() ? http::status::ok : http::status::service_unavailable,
                             "text/plain; charset=utf-8", (trouble.empty() ? "ok" : trouble) + '\n'));
    } else if (asked.path == session_path) {
        session(asked);
    } else if (const PageFile* const file = page_at(asked.path, handler.page());
               file != nullptr && asked.is(http::verb::get)) {
        answer(make_response(request, http::status::ok, std::string(file->type), std::string(file->bytes)));
    } else if (asked.path == "/products.js" && asked.is(http::verb::get)) {
        answer(make_response(request, http::status::ok, "text/javascript; charset=utf-8", products_script()));
    } else if (asked.path == "/turbo.js" && asked.is(http::verb::get)) {
        answer(make_response(request, http::status::ok, "text/javascript; charset=utf-8", turbo_script()));
    } else if (asked.right < Right::view) {
        asked.error(http::status::unauthorized,
                    "a token is needed; the page asks for it, others send it as a bearer token");
    } else {
        handler.view(asked);
    }
}

void Routes::session(const Asked& asked) {
    if (asked.is(http::verb::get)) {
        asked.json(session_json(access_, asked.right));
        return;
    }
    const std::optional<std::string> token = log_in_token(asked.request);
    if (!token) {
        asked.error(http::status::bad_request, "allowed: POST {\"token\": \"...\"} as application/json");
        return;
    }
    const std::string cookie = access_.log_in(*token, visitor_of(asked.request).host);
    if (cookie.empty()) {
        refuse_token(asked);
        return;
    }
    const std::string pair = cookie.substr(0, cookie.find(';'));
    Visitor known = visitor_of(asked.request);
    known.cookie = pair;
    Response response = make_response(asked.request, http::status::ok, "application/json",
                                      session_json(access_, access_.right_of(known)));
    response.set(http::field::set_cookie, cookie);
    asked.answer(std::move(response));
}

/// A wrong token is answered late: guessing is slow, and a right one waits for nobody.
void Routes::refuse_token(const Asked& asked) {
    const auto timer = std::make_shared<boost::asio::steady_timer>(network_, pause_after_wrong_token);
    timer->async_wait([timer, answer = asked.answer,
                       request = std::make_shared<const Request>(asked.request)](const boost::system::error_code&) {
        answer(error_response(*request, http::status::forbidden, "this token is not known"));
    });
}

}  // namespace disparityd::web
