// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/connections.h"

namespace disparityd::web {

bool Connections::admit(const std::shared_ptr<Connection>& connection, const Connection* instead_of) {
    for (std::weak_ptr<Connection>& place : all_) {
        if (instead_of != nullptr && place.lock().get() == instead_of) {
            place = connection;
            return true;
        }
    }
    all_.remove_if([](const std::weak_ptr<Connection>& other) { return other.expired(); });
    if (all_.size() >= most_) {
        for (auto place = all_.begin(); place != all_.end(); ++place) {
            const auto other = place->lock();
            if (other && other->idle()) {
                all_.erase(place);
                other->drop();
                break;
            }
        }
    }
    if (all_.size() >= most_) {
        return false;
    }
    all_.push_back(connection);
    return true;
}

void Connections::drop_all() {
    for (const auto& weak : all_) {
        if (const auto connection = weak.lock()) {
            connection->drop();
        }
    }
}

}  // namespace disparityd::web
