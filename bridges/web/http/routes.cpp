// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/routes.h"

#include <algorithm>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "bridges/web/daemon/hub.h"
#include "bridges/web/foxglove/status_schema.h"
#include "bridges/web/http/page_files.h"
#include "bridges/web/images/colours.h"
#include "bridges/web/images/snapshot.h"
#include "bridges/web/metrics/prometheus_text.h"
#include "clients/json/message_json.h"

namespace disparityd::web {
namespace {

/// Waits for one frame with these products, for a snapshot. The network's thread calls it.
class FrameRequest : public Listener, public std::enable_shared_from_this<FrameRequest> {
public:
    using Answer = std::function<void(std::shared_ptr<const LiveFrame>)>;

    /// Calls `answer` once, with the first frame that has all the `needed` products, or with nullptr after 3 s. Frames
    /// have the `welcome` ones, too, where the daemon serves them.
    static void start(boost::asio::io_context& network, Hub& hub, std::set<disparity::Product> needed,
                      const std::set<disparity::Product>& welcome, Answer answer);

    void on_frame(const std::shared_ptr<const LiveFrame>& frame) override;
    void on_state(const DaemonState&) override {}
    void on_sensors(const disparity::SensorBatch&) override {}
    Wants wants() const override;

private:
    FrameRequest(boost::asio::io_context& network, Hub& hub) : hub_(hub), timer_(network) {}
    void finish(const std::shared_ptr<const LiveFrame>& frame);

    Hub& hub_;
    boost::asio::steady_timer timer_;
    std::set<disparity::Product> needed_;
    std::set<disparity::Product> wanted_;
    Answer answer_;
};

void FrameRequest::start(boost::asio::io_context& network, Hub& hub, std::set<disparity::Product> needed,
                         const std::set<disparity::Product>& welcome, Answer answer) {
    constexpr std::chrono::seconds patience{3};
    const std::shared_ptr<FrameRequest> request(new FrameRequest(network, hub));
    request->wanted_ = needed;
    request->wanted_.insert(welcome.begin(), welcome.end());
    request->needed_ = std::move(needed);
    request->answer_ = std::move(answer);
    request->timer_.expires_after(patience);
    // The timer keeps the request alive.
    request->timer_.async_wait([request](const boost::system::error_code&) { request->finish(nullptr); });
    hub.add(request);
}

void FrameRequest::on_frame(const std::shared_ptr<const LiveFrame>& frame) {
    const auto has = [&](disparity::Product product) { return frame->frame.plane(product) != nullptr; };
    if (std::all_of(needed_.begin(), needed_.end(), has)) {
        finish(frame);
    }
}

Wants FrameRequest::wants() const {
    return answer_ ? Wants{wanted_, false} : Wants{};
}

void FrameRequest::finish(const std::shared_ptr<const LiveFrame>& frame) {
    if (const Answer answer = std::exchange(answer_, nullptr)) {
        timer_.cancel();
        hub_.update_wants();
        answer(frame);
    }
}

}  // namespace

namespace http = boost::beast::http;
using disparity::Product;
using json::Json;
using json::to_text;

/// A request that is being answered.
struct Routes::Asked {
    const Request& request;
    const std::string& peer;
    const Answer& answer;
    std::string path;
    Right right;

    void json(const std::string& text) const {
        answer(make_response(request, http::status::ok, "application/json", text));
    }
    void error(http::status status, const std::string& line) const { answer(error_response(request, status, line)); }
    bool is(http::verb verb) const {
        return request.method() == verb || (verb == http::verb::get && request.method() == http::verb::head);
    }
};

namespace {

constexpr const char* session_path = "/api/session";
constexpr int most_requests = 8;   ///< to the daemon at a time
constexpr int most_looks = 4;      ///< of those, by visitors who only ask
constexpr int most_snapshots = 4;  ///< at a time: each may take tens of MB
constexpr std::chrono::seconds pause_after_wrong_token{1};
constexpr const char* too_many = "too many of these requests are under way; try again";

std::string_view text_of(boost::beast::string_view text) {
    return {text.data(), text.size()};
}

/// Returns the body as an object; nothing when it is none. A page of another server cannot send this type unasked.
std::optional<Json> body_of(const Request& request) {
    if (text_of(request[http::field::content_type]).substr(0, 16) != "application/json") {
        return std::nullopt;
    }
    Json body = Json::parse(request.body(), nullptr, false);
    return body.is_object() ? std::optional<Json>(std::move(body)) : std::nullopt;
}

std::string text_in(const Json& body, const char* key) {
    const auto found = body.find(key);
    return found != body.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::string session_json(const Access& access, Right right) {
    return to_text(
        {{"needs_token", access.needs_token()}, {"view", right >= Right::view}, {"control", right >= Right::control}},
        -1);
}

std::string message_json(const Hub& hub) {
    const DaemonState& state = hub.state();
    return to_text({{"daemon", state.there ? "there" : "gone"},
                    {"why", state.why},
                    {"status", state.status ? json::to_json(*state.status) : Json()},
                    {"web", {{"clients", hub.counters.clients}}}},
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

/// What a snapshot is made from.
struct SnapshotKind {
    std::string type;
    std::set<Product> needed;
    std::set<Product> welcome;
    std::function<std::string(const LiveFrame&)> make;
};

std::optional<SnapshotKind> snapshot_kind(const std::string& path, Image image) {
    if (path == "/snapshot.ply") {
        return SnapshotKind{
            "application/octet-stream", {Product::disparity, Product::left}, products_of(Image::left), ply_of};
    }
    if (path == "/snapshot.png") {
        return SnapshotKind{"image/png", {product_of(image)}, products_of(image), [image](const LiveFrame& live) {
                                return png_of(live, image);
                            }};
    }
    if (path == "/snapshot.jpg") {
        return SnapshotKind{"image/jpeg", {product_of(image)}, products_of(image), [image](const LiveFrame& live) {
                                constexpr int quality = 92;
                                const auto made = encode(live, {image, Encoding::jpeg, 0, quality, std::nullopt});
                                return made ? *made->bytes : std::string();
                            }};
    }
    return std::nullopt;
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

void Routes::respond(const Request& request, const std::string& peer, const Answer& answer) {
    const Visitor visitor = visitor_of(request);
    const Asked asked{request, peer, answer, path_of(request), access_.right_of(visitor)};
    if (const std::string why = access_.refuses(visitor); !why.empty()) {
        asked.error(http::status::forbidden, why);
    } else if (asked.path == "/healthz" && asked.is(http::verb::get)) {
        const DaemonState& state = place_.hub.state();
        const bool runs =
            state.there && state.status && (state.status->state() == "running" || state.status->state() == "idle");
        const std::string reason = !state.there   ? state.why
                                   : state.status ? state.status->state()
                                                  : "asking the daemon";
        answer(make_response(request, runs ? http::status::ok : http::status::service_unavailable,
                             "text/plain; charset=utf-8", runs ? "ok\n" : reason + '\n'));
    } else if (asked.path == session_path) {
        session(asked);
    } else if (const PageFile* const file = page_file(asked.path); file != nullptr && asked.is(http::verb::get)) {
        answer(make_response(request, http::status::ok, std::string(file->type), std::string(file->bytes)));
    } else if (asked.path == "/products.js" && asked.is(http::verb::get)) {
        answer(make_response(request, http::status::ok, "text/javascript; charset=utf-8", products_script()));
    } else if (asked.path == "/turbo.js" && asked.is(http::verb::get)) {
        answer(make_response(request, http::status::ok, "text/javascript; charset=utf-8", turbo_script()));
    } else if (asked.right < Right::view) {
        asked.error(http::status::unauthorized,
                    "a token is needed; the page asks for it, others send it as a bearer token");
    } else {
        view(asked);
    }
}

void Routes::view(const Asked& asked) {
    if (asked.path.compare(0, 10, "/snapshot.") == 0 && asked.is(http::verb::get)) {
        snapshot(asked);
    } else if (asked.path == "/metrics" && asked.is(http::verb::get)) {
        const DaemonState& state = place_.hub.state();
        asked.answer(make_response(asked.request, http::status::ok, "text/plain; version=0.0.4; charset=utf-8",
                                   prometheus_text(state.there ? state.status.get() : nullptr, place_.hub.counters)));
    } else if (asked.path == "/api/status" && asked.is(http::verb::get)) {
        asked.json(message_json(place_.hub));
    } else if (asked.path == "/api/status/schema" && asked.is(http::verb::get)) {
        asked.json(foxglove::status_schema());
    } else if (asked.path == "/api/camera" && asked.is(http::verb::get)) {
        if (requests_under_way_ >= most_looks) {
            asked.error(http::status::service_unavailable, too_many);
        } else {
            control_.set_controls({}, to_answer(asked));
        }
    } else if (asked.path == "/api/camera" || asked.path == "/api/recording") {
        control(asked);
    } else {
        asked.error(http::status::not_found, "there is nothing of this name here");
    }
}

void Routes::control(const Asked& asked) {
    if (asked.right < Right::control) {
        asked.error(http::status::forbidden,
                    "you may look, not control: a control token is needed, or disparity-web --allow-control");
    } else if (requests_under_way_ >= most_requests) {
        asked.error(http::status::service_unavailable, too_many);
    } else if (asked.path == "/api/camera" && asked.is(http::verb::post)) {
        camera(asked);
    } else if (asked.path == "/api/recording") {
        recording(asked);
    } else {
        asked.error(http::status::method_not_allowed, "this method means nothing here");
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
    const auto timer = std::make_shared<boost::asio::steady_timer>(place_.network, pause_after_wrong_token);
    timer->async_wait([timer, answer = asked.answer,
                       request = std::make_shared<const Request>(asked.request)](const boost::system::error_code&) {
        answer(error_response(*request, http::status::forbidden, "this token is not known"));
    });
}

void Routes::snapshot(const Asked& asked) {
    const std::string name = query_of(asked.request, "image");
    const std::optional<Image> image = image_of(name.empty() ? "disparity" : name);
    if (!image) {
        asked.error(http::status::bad_request, "image: allowed: " + image_names());
        return;
    }
    std::optional<SnapshotKind> kind = snapshot_kind(asked.path, *image);
    if (!kind) {
        asked.error(http::status::not_found, "allowed: /snapshot.jpg, /snapshot.png, /snapshot.ply");
        return;
    }
    for (const Product product : kind->needed) {
        if (const std::string why = why_not_served(place_.hub.state(), product); !why.empty()) {
            asked.error(http::status::not_found, why);
            return;
        }
    }
    const bool room = place_.outgoing.has_room(std::chrono::steady_clock::now(), Outgoing::most_for_snapshots);
    if (snapshots_under_way_ >= most_snapshots || !room) {
        asked.error(http::status::service_unavailable, too_many);
        return;
    }
    ++snapshots_under_way_;
    const auto request = std::make_shared<const Request>(asked.request);
    const auto finish = [this, request, peer = asked.peer, answer = asked.answer,
                         kind](const std::shared_ptr<const LiveFrame>& live) {
        if (live == nullptr) {
            --snapshots_under_way_;
            const DaemonState& state = place_.hub.state();
            answer(error_response(*request, http::status::service_unavailable,
                                  state.there ? "no frame with this image came within 3 s" : state.why));
            return;
        }
        make_snapshot(request, peer, answer, kind->type, [make = kind->make, live] { return make(*live); });
    };
    FrameRequest::start(place_.network, place_.hub, kind->needed, kind->welcome, finish);
}

/// Makes the file in the encoding thread. The answer stays the network's: its last reference ends there.
void Routes::make_snapshot(const std::shared_ptr<const Request>& request, const std::string& peer, const Answer& answer,
                           const std::string& type, std::function<std::string()> make) {
    auto finish = [this, answer](const std::shared_ptr<Response>& response) {
        --snapshots_under_way_;
        answer(std::move(*response));
    };
    place_.encoding.add(peer, [&network = place_.network, request, type, make = std::move(make),
                               finish = std::move(finish)]() mutable {
        const auto response = std::make_shared<Response>();
        try {
            *response = make_response(*request, http::status::ok, type, make());
            response->set(http::field::content_disposition, "inline; filename=\"" + path_of(*request).substr(1) + '"');
        } catch (const std::exception& error) {
            *response = error_response(*request, http::status::conflict, error.what());
        }
        boost::asio::post(network, [finish = std::move(finish), response] { finish(response); });
    });
}

void Routes::camera(const Asked& asked) {
    const std::optional<Json> body = body_of(asked.request);
    const std::string name = body ? text_in(*body, "name") : "";
    const bool has_value = !name.empty() && body->contains("value") && body->at("value").is_number_integer();
    if (!has_value || (body->at("value").is_number_unsigned() &&
                       body->at("value").get<std::uint64_t>() > std::numeric_limits<std::int64_t>::max())) {
        asked.error(http::status::bad_request,
                    "allowed: POST {\"name\": \"gain-left\", \"value\": 3} as application/json");
        return;
    }
    control_.set_controls({{name, body->at("value").get<std::int64_t>()}}, to_answer(asked));
}

void Routes::recording(const Asked& asked) {
    if (asked.is(http::verb::delete_)) {
        control_.stop_recording(to_answer(asked));
        return;
    }
    const std::optional<Json> body = asked.is(http::verb::post) ? body_of(asked.request) : std::nullopt;
    const std::string path = body ? text_in(*body, "path") : "";
    if (path.empty()) {
        asked.error(http::status::bad_request, "allowed: POST {\"path\": \"name.mkv\"} as application/json, or DELETE");
        return;
    }
    control_.start_recording(path, to_answer(asked));
}

/// Returns a function that brings the daemon's answer from its thread to the network's.
std::function<void(ControlAnswer)> Routes::to_answer(const Asked& asked) {
    ++requests_under_way_;
    const auto request = std::make_shared<const Request>(asked.request);
    auto finish = [this, request, answer = asked.answer](const ControlAnswer& result) {
        --requests_under_way_;
        answer(result.done ? make_response(*request, http::status::ok, "application/json", result.text)
                           : error_response(*request, http::status::conflict, result.text));
    };
    // The answer stays the network's: its last reference ends there.
    return [&network = place_.network,
            finish = std::make_shared<decltype(finish)>(std::move(finish))](const ControlAnswer& result) mutable {
        boost::asio::post(network, [finish = std::move(finish), result] { (*finish)(result); });
    };
}

}  // namespace disparityd::web
