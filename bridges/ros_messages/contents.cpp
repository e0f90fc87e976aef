// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/contents.h"

#include <algorithm>
#include <array>
#include <utility>

namespace disparityd::ros {
namespace {

using disparity::Product;

bool offers(const Offer& offer, Product product) {
    return std::find(offer.products.begin(), offer.products.end(), product) != offer.products.end();
}

constexpr std::array left_products{Product::left_colour, Product::left};
constexpr std::array right_products{Product::right_colour, Product::right};
constexpr std::array left_grey{Product::left};
constexpr std::array right_grey{Product::right};
constexpr std::array disparities{Product::disparity};
constexpr std::array depths{Product::depth};
constexpr std::array depths_or_disparities{Product::depth, Product::disparity};
constexpr std::array disparities_or_depths{Product::disparity, Product::depth};
constexpr std::array depth_errors{Product::depth_error};
constexpr std::array confidences{Product::confidence};
constexpr std::array scans{Product::scan};
constexpr std::array raw_left{Product::raw_left};
constexpr std::array raw_right{Product::raw_right};
/// With the fewest bytes first, for what needs only what comes beside the planes.
constexpr std::array any_product{Product::scan,      Product::confidence,  Product::left,       Product::depth,
                                 Product::disparity, Product::depth_error, Product::left_colour};

/// Returns the first of these products that is offered.
std::optional<Wanted> first_of(const Offer& offer, std::span<const Product> order) {
    const auto found =
        std::find_if(order.begin(), order.end(), [&](Product product) { return offers(offer, product); });
    return found == order.end() ? std::nullopt : std::optional(Wanted{.products = {*found}});
}

std::optional<Wanted> points_needs(const Offer& offer) {
    std::optional<Wanted> needs = offer.calibrated ? first_of(offer, disparities_or_depths) : std::nullopt;
    const std::optional<Wanted> paint = first_of(offer, left_products);
    if (needs && paint) {
        needs->add(*paint);
    }
    return needs;
}

}  // namespace

Offer offer_of(const v1::Status& status) {
    std::vector<Product> products;
    for (const int product : status.products()) {
        products.push_back(static_cast<Product>(product));
    }
    const v1::Geometry& geometry = status.geometry();
    const bool prepared = geometry.width() > 0;  // else the daemon does not know its source yet
    return {.products = std::move(products),
            .calibrated = geometry.f() > 0 && geometry.baseline_mm() > 0,
            .sensors = status.has_sensors() || (prepared && !status.has_camera() && !status.synthetic()),
            .lenses = status.has_raw_cameras()};
}

void Wanted::add(const Wanted& other) {
    for (const Product product : other.products) {
        const auto place = std::lower_bound(products.begin(), products.end(), product);
        if (place == products.end() || *place != product) {
            products.insert(place, product);
        }
    }
    sensors = sensors || other.sensors;
    status = status || other.status;
}

std::span<const Product> products_for(Content content) {
    switch (content) {
        case Content::left_image:
        case Content::left_jpeg: return left_products;
        case Content::right_image: return right_products;
        case Content::left_grey_image: return left_grey;
        case Content::right_grey_image: return right_grey;
        case Content::disparity: return disparities;
        case Content::depth: return depths_or_disparities;
        case Content::depth_mm:
        case Content::compressed_depth: return depths;
        case Content::depth_error: return depth_errors;
        case Content::confidence: return confidences;
        case Content::points: return disparities_or_depths;
        case Content::scan: return scans;
        case Content::raw_left_image:
        case Content::raw_left_info: return raw_left;
        case Content::raw_right_image:
        case Content::raw_right_info: return raw_right;
        case Content::left_info:
        case Content::right_info:
        case Content::transforms:
        case Content::clock: return any_product;
        default: return {};
    }
}

std::optional<Wanted> needs_of(Content content, const Offer& offer) {
    switch (content) {
        case Content::left_info:
        case Content::right_info: return offer.calibrated ? first_of(offer, any_product) : std::nullopt;
        case Content::depth: return first_of(offer, offer.calibrated ? products_for(content) : depths);
        case Content::points: return points_needs(offer);
        case Content::raw_left_info:
        case Content::raw_right_info:
            return offer.calibrated && offer.lenses ? first_of(offer, products_for(content)) : std::nullopt;
        case Content::imu:
        case Content::magnetic_field:
        case Content::imu_temperature:
        case Content::camera_temperature:
        case Content::left_temperature:
        case Content::right_temperature:
        case Content::pressure:
        case Content::humidity: return offer.sensors ? std::optional(Wanted{.sensors = true}) : std::nullopt;
        case Content::status:
        case Content::diagnostics: return Wanted{.status = true};
        default: return first_of(offer, products_for(content));
    }
}

}  // namespace disparityd::ros
