// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/all_daemons.h"

#include <chrono>
#include <exception>
#include <set>
#include <utility>

#include <boost/asio/post.hpp>

#include "bridges/web/foxglove/status_schema.h"
#include "bridges/web/metrics/prometheus_text.h"
#include "clients/json/message_json.h"
#include "proto/shared_memory_layout.h"
#include "proto/socket_places.h"

namespace disparityd::web {
namespace {

namespace http = boost::beast::http;
using json::Json;

constexpr std::string_view prefix = "/i/";
/// Threads that the system refuses now it may grant later.
constexpr std::chrono::seconds pause_before_retry{5};

Json entry_of(const std::string& name, const DaemonState& state) {
    Json entry{{"name", name},
               {"path", std::string(prefix) + name + '/'},
               {"daemon", state.there ? "there" : "gone"},
               {"why", state.why}};
    if (state.there && state.status) {
        const v1::Status& status = *state.status;
        entry["state"] = status.state();
        entry["detail"] = status.detail();
        entry["source"] = status.source();
        entry["rate"] = status.rate();
        entry["synthetic"] = status.synthetic();
        entry["camera"] = status.has_camera() ? Json({{"state", status.camera().state()}}) : Json();
        entry["trust"] = {{"alarm", status.trust().alarm()}};
        entry["recording"] = status.record().active();
    }
    return entry;
}

std::string text_of_names(const std::set<std::string>& names) {
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : ", ") + name;
    }
    return text;
}

}  // namespace

std::string_view daemon_in_path(std::string_view path) {
    if (!path.starts_with(prefix)) {
        return {};
    }
    path.remove_prefix(prefix.size());
    const std::string_view name = path.substr(0, path.find('/'));
    return proto::is_daemon_name(std::string(name)) ? name : std::string_view();
}

AllDaemons::AllDaemons(const ServerParts& parts)
    : parts_(parts),
      folders_(proto::socket_folders()),
      retry_(parts.network),
      watch_(folders_, [this](std::set<std::string> names) {
          boost::asio::post(parts_.network, [this, names = std::move(names)] { on_names(names); });
      }) {}

/// Begins with those of the present names that are not served yet. What is refused for one holds no other.
void AllDaemons::add_new() {
    beyond_.clear();
    left_out_.clear();
    for (const std::string& name : present_) {
        if (daemons_.count(name) != 0) {
            continue;
        }
        if (daemons_.size() >= most) {
            beyond_.insert(name);
            continue;
        }
        try {
            daemons_.emplace(name, std::make_unique<ServedDaemon>(parts_, DaemonAddress{name, {}, true},
                                                                  ServedDaemon::Unwatched::seldom));
        } catch (const std::exception& error) {
            left_out_[error.what()].insert(name);
        }
    }
    if (!left_out_.empty()) {
        try_again_later();
    }
}

void AllDaemons::try_again_later() {
    retry_.expires_after(pause_before_retry);
    retry_.async_wait([this](const boost::system::error_code& ended) {
        if (!ended) {
            add_new();
        }
    });
}

void AllDaemons::on_names(const std::set<std::string>& names) {
    present_ = names;
    add_new();
    for (const auto& [name, daemon] : daemons_) {
        daemon->set_present(names.count(name) != 0, "the daemon named " + name +
                                                        " has stopped: its socket is gone; start it again, or look "
                                                        "into its log");
    }
}

Destination AllDaemons::destination(std::string_view path) {
    const std::string_view name = daemon_in_path(path);
    if (name.empty()) {
        return {nullptr, &overview_, 0};
    }
    const std::size_t size = prefix.size() + name.size();
    const auto found = daemons_.find(name);
    return found == daemons_.end() ? Destination{nullptr, &absent_, size} : found->second->destination(size);
}

void AllDaemons::stop() {
    watch_.stop();
    for (const auto& [name, daemon] : daemons_) {
        daemon->stop();
    }
}

void AllDaemons::Overview::view(const Asked& asked) {
    if (asked.path == "/api/instances" && asked.is(http::verb::get)) {
        asked.json(list_json());
    } else if (asked.path == "/metrics" && asked.is(http::verb::get)) {
        std::vector<NamedStatus> all;
        for (const auto& [name, daemon] : all_.daemons_) {
            const DaemonState& state = daemon->state();
            all.push_back({name, state.there ? state.status.get() : nullptr});
        }
        asked.metrics(prometheus_text(all, all_.parts_.counters));
    } else if (asked.path == "/api/status/schema" && asked.is(http::verb::get)) {
        asked.json(foxglove::status_schema());
    } else {
        asked.error(http::status::not_found,
                    "there is nothing of this name here; what belongs to a daemon is below /i/NAME/, and "
                    "/api/instances lists the names");
    }
}

std::string AllDaemons::Overview::list_json() const {
    Json list = Json::array();
    for (const auto& [name, daemon] : all_.daemons_) {
        list.push_back(entry_of(name, daemon->state()));
    }
    return json::to_text({{"instances", list}, {"note", note()}, {"web", {{"clients", all_.parts_.counters.clients}}}},
                         -1);
}

/// Returns what the list does not show, and why; "" where it shows all.
std::string AllDaemons::Overview::note() const {
    if (all_.daemons_.empty() && all_.left_out_.empty()) {
        return why_no_daemon(all_.folders_);
    }
    std::string note;
    for (const auto& [why, names] : all_.left_out_) {
        note += std::string("not shown: ") + text_of_names(names) + ": " + why + "; it is tried again every " +
                std::to_string(pause_before_retry.count()) + " s. ";
    }
    if (!all_.beyond_.empty()) {
        note += "not shown: " + text_of_names(all_.beyond_) + "; " + std::to_string(most) +
                " daemons are the most, those that have gone among them: start disparity-web again to forget these";
    }
    return note;
}

std::string AllDaemons::Overview::trouble() const {
    std::string lines;
    for (const auto& [name, daemon] : all_.daemons_) {
        if (const std::string why = why_not_running(daemon->state()); !why.empty()) {
            lines += (lines.empty() ? "" : "\n") + name + ": " + why;
        }
    }
    for (const auto& [why, names] : all_.left_out_) {
        lines += (lines.empty() ? "" : "\n") + text_of_names(names) + ": not read: " + why;
    }
    return all_.daemons_.empty() && lines.empty() ? why_no_daemon(all_.folders_) : lines;
}

void AllDaemons::Absent::view(const Asked& asked) {
    asked.error(http::status::not_found, trouble());
}

std::string AllDaemons::Absent::trouble() const {
    return "no daemon of this name was found on this machine yet; it is looked for once a second, and /api/instances "
           "lists those that were";
}

}  // namespace disparityd::web
