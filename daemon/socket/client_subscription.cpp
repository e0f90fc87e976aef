// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/client_subscription.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "proto/products.h"

namespace disparityd::daemon {
namespace {

/// What a client is told that wants a product which is not made.
std::string refused_product(int number, const std::vector<v1::Product>& made) {
    std::string allowed;
    for (const v1::Product product : made) {
        allowed += (allowed.empty() ? "" : ", ") + v1::Product_Name(product);
    }
    const auto wanted = std::find_if(proto::products.begin(), proto::products.end(),
                                     [number](const proto::ProductFacts& one) { return one.number == number; });
    if (wanted == proto::products.end() || wanted->key.empty()) {
        return fmt::format("products: found {}, allowed: {}", number, allowed);
    }
    return fmt::format("products: found {}, allowed: {}; for {} set {} = true in the daemon's configuration",
                       v1::Product_Name(wanted->number), allowed, wanted->name, wanted->key);
}

Selection::Region region_of(const v1::Subscribe& wanted) {
    return {wanted.region().x(), wanted.region().y(), wanted.region().width(), wanted.region().height()};
}

bool has(const std::vector<v1::Product>& products, v1::Product product) {
    return std::find(products.begin(), products.end(), product) != products.end();
}

/// Cuts the region to the image, which may be smaller after a reload. Returns false if nothing of it is left.
bool clamp_region(const FrameCopy& frame, Selection& selection) {
    auto& region = selection.region;
    if (region_problem(region, frame.info.width, frame.info.height).empty()) {
        return true;
    }
    if (region.x >= frame.info.width || region.y >= frame.info.height) {
        return false;
    }
    region.width = std::min(region.width, frame.info.width - region.x);
    region.height = std::min(region.height, frame.info.height - region.y);
    return true;
}

}  // namespace

std::string ClientSubscription::problem(const v1::Subscribe& wanted, const StreamLayout& layout) {
    const double interval = wanted.status_interval_s();
    if (!(interval >= 0 && interval <= longest_status_interval_s)) {
        return fmt::format("status_interval_s: found {:g}, allowed: 0 (none) .. {:g}", interval,
                           longest_status_interval_s);
    }
    if (layout.products.empty()) {
        return {};
    }
    for (const int number : wanted.products()) {
        if (!has(layout.products, static_cast<v1::Product>(number))) {
            return refused_product(number, layout.products);
        }
    }
    if (const std::string wrong = region_problem(region_of(wanted), layout.geometry.width, layout.geometry.height);
        !wrong.empty()) {
        return "region: " + wrong;
    }
    if (wanted.encoding() != v1::RAW && wanted.encoding() != v1::ZSTD) {
        return fmt::format("encoding: found {}, allowed: 0 (raw) or 1 (zstd)", static_cast<int>(wanted.encoding()));
    }
    if (!std::isfinite(wanted.max_rate()) || wanted.max_rate() < 0) {
        return fmt::format("max_rate: found {}, allowed: 0 (every frame) or more", wanted.max_rate());
    }
    return {};
}

void ClientSubscription::start(const v1::Subscribe& wanted, const FrameRing& frames, const SensorRing& samples) {
    kept_.reset();  // this one replaces it
    Selection selection;
    for (const int number : wanted.products()) {
        if (const auto product = static_cast<v1::Product>(number); !has(selection.products, product)) {
            selection.products.push_back(product);
        }
    }
    selection.region = region_of(wanted);
    selection.encoding = wanted.encoding();
    selection_ = std::move(selection);
    if (wanted.sensors() && !sensors_) {
        next_sample_ = samples.end();
    }
    sensors_ = wanted.sensors();
    credit_.start(wanted.by_credit());
    feed_.start(frames, wanted.max_rate(),
                wanted.by_credit() ? FrameFeed::Order::newest_only : FrameFeed::Order::oldest_first);
}

void ClientSubscription::keep(const v1::Subscribe& wanted) {
    kept_ = wanted;
    credit_.start(wanted.by_credit());
}

bool ClientSubscription::drop_products_not_in(const std::vector<v1::Product>& offered) {
    return std::erase_if(selection_.products, [&offered](v1::Product product) { return !has(offered, product); }) > 0;
}

ClientSubscription::Taken ClientSubscription::take_frame(const FrameRing& frames) {
    Taken taken{{feed_.take(frames, products()), selection_}};
    if (!taken.request.frame) {
        return taken;
    }
    credit_.take();
    if (!clamp_region(*taken.request.frame, taken.request.selection)) {
        taken.request.frame = nullptr;
        taken.region_is_outside = true;
        selection_ = {};
    }
    return taken;
}

void ClientSubscription::take_samples(const SensorRing& samples, v1::Sensors& message) {
    next_sample_ = samples.fill(next_sample_, message);
}

}  // namespace disparityd::daemon
