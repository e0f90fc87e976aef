// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/daemon_routes.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "bridges/web/daemon/hub.h"
#include "bridges/web/foxglove/status_schema.h"
#include "bridges/web/http/request_body.h"
#include "bridges/web/images/snapshot.h"
#include "bridges/web/metrics/prometheus_text.h"

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

namespace {

constexpr int most_requests = 8;   ///< to the daemon at a time
constexpr int most_looks = 4;      ///< of those, by visitors who only ask
constexpr int most_snapshots = 4;  ///< at a time: each may take tens of MB
constexpr const char* too_many = "too many of these requests are under way; try again";

std::string message_json(const DaemonState& state, const WebCounters& counters) {
    return to_text({{"daemon", state.there ? "there" : "gone"},
                    {"why", state.why},
                    {"status", state.status ? json::to_json(*state.status) : Json()},
                    {"web", {{"clients", counters.clients}}}},
                   -1);
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

std::string DaemonRoutes::trouble() const {
    return why_not_running(place_.hub.state());
}

std::string why_not_running(const DaemonState& state) {
    if (!state.there) {
        return state.why;
    }
    const std::string now = state.status ? state.status->state() : "asking the daemon";
    return now == "running" || now == "idle" ? std::string() : now;
}

void DaemonRoutes::view(const Asked& asked) {
    if (asked.path.compare(0, 10, "/snapshot.") == 0 && asked.is(http::verb::get)) {
        snapshot(asked);
    } else if (asked.path == "/metrics" && asked.is(http::verb::get)) {
        const DaemonState& state = place_.hub.state();
        asked.metrics(prometheus_text(state.there ? state.status.get() : nullptr, place_.counters));
    } else if (asked.path == "/api/status" && asked.is(http::verb::get)) {
        asked.json(message_json(place_.hub.state(), place_.counters));
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

void DaemonRoutes::control(const Asked& asked) {
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

void DaemonRoutes::snapshot(const Asked& asked) {
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
void DaemonRoutes::make_snapshot(const std::shared_ptr<const Request>& request, const std::string& peer,
                                 const Answer& answer, const std::string& type, std::function<std::string()> make) {
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

void DaemonRoutes::camera(const Asked& asked) {
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

void DaemonRoutes::recording(const Asked& asked) {
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
std::function<void(ControlAnswer)> DaemonRoutes::to_answer(const Asked& asked) {
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
