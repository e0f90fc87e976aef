// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon/hub.h"

#include <algorithm>
#include <utility>

#include "proto/products.h"

namespace disparityd::web {

std::string why_not_served(const DaemonState& state, disparity::Product product) {
    const bool served = std::find(state.products.begin(), state.products.end(), product) != state.products.end();
    if (!state.there || served) {
        return {};
    }
    return proto::not_served_text(static_cast<v1::Product>(product));
}

template <typename Call>
void Hub::for_each(const Call& call) {
    // A listener that is told something may end, and others may come: they are told the next thing.
    std::vector<std::shared_ptr<Listener>> living;
    std::erase_if(listeners_, [&](const std::weak_ptr<Listener>& listener) {
        auto alive = listener.lock();
        const bool gone = alive == nullptr;
        if (!gone) {
            living.push_back(std::move(alive));
        }
        return gone;
    });
    for (const auto& listener : living) {
        call(*listener);
    }
}

void Hub::add(const std::weak_ptr<Listener>& listener) {
    listeners_.push_back(listener);
    update_wants();
}

void Hub::update_wants() {
    Wants all;
    for_each([&](const Listener& listener) {
        const Wants wants = listener.wants();
        all.products.insert(wants.products.begin(), wants.products.end());
        all.sensors = all.sensors || wants.sensors;
        all.status = all.status || wants.status;
    });
    std::erase_if(all.products, [this](disparity::Product product) {
        return std::find(state_.products.begin(), state_.products.end(), product) == state_.products.end();
    });
    on_wants_(all);
}

void Hub::on_frame(const std::shared_ptr<const LiveFrame>& frame) {
    for_each([&](Listener& listener) { listener.on_frame(frame); });
}

void Hub::on_state(DaemonState state) {
    const bool other_products = state.products != state_.products;
    state_ = std::move(state);
    if (other_products) {
        update_wants();
    }
    for_each([&](Listener& listener) { listener.on_state(state_); });
}

void Hub::on_sensors(const disparity::SensorBatch& batch) {
    for_each([&](Listener& listener) { listener.on_sensors(batch); });
}

}  // namespace disparityd::web
