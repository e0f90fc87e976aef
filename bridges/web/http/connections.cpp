// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/connections.h"

#include <algorithm>
#include <iterator>
#include <map>

namespace disparityd::web {
namespace {

/// An eighth of the places is kept: of 128 sixteen, enough for the requests of some pages and of monitoring.
std::size_t kept_of(std::size_t most, std::size_t least) {
    return std::min(std::max(most / 8, least), most / 2);
}

}  // namespace

Connections::Connections(std::size_t most, bool knows_controllers)
    : most_(most),
      kept_for_requests_(kept_of(most, 2)),
      kept_for_controllers_(knows_controllers ? kept_of(most, 1) : 0) {}

void Connections::forget_ended() {
    all_.remove_if([](const Place& place) { return place.connection.expired(); });
}

std::size_t Connections::streams() const {
    return static_cast<std::size_t>(
        std::count_if(all_.begin(), all_.end(), [](const Place& place) { return place.stay != Stay::request; }));
}

void Connections::end(Places::iterator place) {
    const auto connection = place->connection.lock();
    all_.erase(place);
    if (connection) {
        connection->drop();
    }
}

/// Ends the oldest idle one, of streams or of requests. Returns whether there was one.
bool Connections::end_idle(bool streams) {
    const auto found = std::find_if(all_.begin(), all_.end(), [streams](const Place& place) {
        const auto connection = place.connection.lock();
        return (place.stay != Stay::request) == streams && connection && connection->idle();
    });
    if (found == all_.end()) {
        return false;
    }
    end(found);
    return true;
}

/// Ends the newest connection of the address that has the most, when it has at least two more than the newcomer's:
/// exchanging places without end helps nobody. Only connections of this kind and of no higher right count.
bool Connections::end_one_of_most(const std::string& peer, bool streams, Stay highest) {
    std::map<std::string, std::size_t> counts;
    const auto counted = [&](const Place& place) {
        return (place.stay != Stay::request) == streams && place.stay <= highest;
    };
    for (const Place& place : all_) {
        counts[place.peer] += counted(place) ? 1 : 0;
    }
    const auto most = std::max_element(counts.begin(), counts.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most == counts.end() || most->second < counts[peer] + 2) {
        return false;
    }
    const auto newest = std::find_if(all_.rbegin(), all_.rend(),
                                     [&](const Place& place) { return counted(place) && place.peer == most->first; });
    end(std::prev(newest.base()));
    return true;
}

bool Connections::end_viewer() {
    const auto newest =
        std::find_if(all_.rbegin(), all_.rend(), [](const Place& place) { return place.stay == Stay::viewer; });
    if (newest == all_.rend()) {
        return false;
    }
    end(std::prev(newest.base()));
    return true;
}

bool Connections::admit(const std::shared_ptr<Connection>& connection, const std::string& peer) {
    forget_ended();
    if (full() && !end_idle(false) && !end_idle(true) && !end_one_of_most(peer, false, Stay::request)) {
        return false;
    }
    all_.push_back({connection, peer, Stay::request});
    return true;
}

bool Connections::promote(const Connection* connection, Stay stay) {
    forget_ended();
    const auto own = std::find_if(all_.begin(), all_.end(), [connection](const Place& place) {
        return place.connection.lock().get() == connection;
    });
    if (own == all_.end()) {
        return false;
    }
    const std::size_t allowed =
        places_for_viewers() + (stay == Stay::controller ? kept_for_controllers_ : std::size_t{0});
    const bool room = streams() < allowed || end_idle(true) || end_one_of_most(own->peer, true, stay) ||
                      (stay == Stay::controller && end_viewer());
    if (room) {
        own->stay = stay;
        all_.splice(all_.end(), all_, own);  // the newest of the streams
    }
    return room;
}

void Connections::hand_over(const Connection* from, const std::shared_ptr<Connection>& to) {
    for (Place& place : all_) {
        if (place.connection.lock().get() == from) {
            place.connection = to;
            return;
        }
    }
}

void Connections::drop_all() {
    for (const Place& place : all_) {
        if (const auto connection = place.connection.lock()) {
            connection->drop();
        }
    }
}

}  // namespace disparityd::web
