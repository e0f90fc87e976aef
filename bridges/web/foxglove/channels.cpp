// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/channels.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <utility>

namespace disparityd::foxglove {
namespace {

using disparity::Product;

constexpr std::array channels{
    ChannelFacts{Channel::left_image, "/left/image_rect", "sensor_msgs/Image"},
    ChannelFacts{Channel::left_jpeg, "/left/image_rect/compressed", "sensor_msgs/CompressedImage"},
    ChannelFacts{Channel::left_info, "/left/camera_info", "sensor_msgs/CameraInfo"},
    ChannelFacts{Channel::right_info, "/right/camera_info", "sensor_msgs/CameraInfo"},
    ChannelFacts{Channel::disparity, "/disparity", "stereo_msgs/DisparityImage"},
    ChannelFacts{Channel::depth, "/depth/image_rect_raw", "sensor_msgs/Image"},
    ChannelFacts{Channel::depth_mm, "/depth/image_rect", "sensor_msgs/Image"},
    ChannelFacts{Channel::depth_error, "/depth/error", "sensor_msgs/Image"},
    ChannelFacts{Channel::confidence, "/confidence", "sensor_msgs/Image"},
    ChannelFacts{Channel::points, "/points", "sensor_msgs/PointCloud2"},
    ChannelFacts{Channel::scan, "/scan", "sensor_msgs/LaserScan"},
    ChannelFacts{Channel::transforms, "/tf", "tf2_msgs/TFMessage"},
    ChannelFacts{Channel::imu, "/imu", "sensor_msgs/Imu"},
    ChannelFacts{Channel::magnetic_field, "/magnetic_field", "sensor_msgs/MagneticField"},
    ChannelFacts{Channel::imu_temperature, "/temperature/imu", "sensor_msgs/Temperature"},
    ChannelFacts{Channel::camera_temperature, "/temperature/camera", "sensor_msgs/Temperature"},
    ChannelFacts{Channel::left_temperature, "/temperature/left", "sensor_msgs/Temperature"},
    ChannelFacts{Channel::right_temperature, "/temperature/right", "sensor_msgs/Temperature"},
    ChannelFacts{Channel::pressure, "/pressure", "sensor_msgs/FluidPressure"},
    ChannelFacts{Channel::humidity, "/humidity", "sensor_msgs/RelativeHumidity"},
    ChannelFacts{Channel::status, "/status", ""},
};

bool offers(const Offer& offer, Product product) {
    return std::find(offer.products.begin(), offer.products.end(), product) != offer.products.end();
}

/// Returns the first of these products that is offered.
std::optional<Wanted> first_of(const Offer& offer, std::initializer_list<Product> order) {
    const auto* found =
        std::find_if(order.begin(), order.end(), [&](Product product) { return offers(offer, product); });
    return found == order.end() ? std::nullopt : std::optional(Wanted{.products = {*found}});
}

/// Returns what brings frames with the fewest bytes, for channels that need only what comes beside the planes.
std::optional<Wanted> any_frame(const Offer& offer) {
    return first_of(offer, {Product::scan, Product::confidence, Product::left, Product::depth, Product::disparity,
                            Product::depth_error, Product::left_colour});
}

std::optional<Wanted> depth_needs(const Offer& offer) {
    if (!offer.calibrated) {
        return first_of(offer, {Product::depth});
    }
    return first_of(offer, {Product::depth, Product::disparity});
}

std::optional<Wanted> points_needs(const Offer& offer) {
    std::optional<Wanted> needs =
        offer.calibrated ? first_of(offer, {Product::disparity, Product::depth}) : std::nullopt;
    const std::optional<Wanted> paint = first_of(offer, {Product::left_colour, Product::left});
    if (needs && paint) {
        needs->add(*paint);
    }
    return needs;
}

}  // namespace

std::span<const ChannelFacts> all_channels() {
    return channels;
}

Offer offer_of(const v1::Status& status, std::vector<Product> products) {
    const v1::Geometry& geometry = status.geometry();
    const bool prepared = geometry.width() > 0;  // else the daemon does not know its source yet
    return {.products = std::move(products),
            .calibrated = geometry.f() > 0 && geometry.baseline_mm() > 0,
            .sensors = status.has_sensors() || (prepared && !status.has_camera() && !status.synthetic())};
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

std::optional<Wanted> needs_of(Channel channel, const Offer& offer) {
    switch (channel) {
        case Channel::left_image:
        case Channel::left_jpeg: return first_of(offer, {Product::left_colour, Product::left});
        case Channel::left_info:
        case Channel::right_info: return offer.calibrated ? any_frame(offer) : std::nullopt;
        case Channel::disparity: return first_of(offer, {Product::disparity});
        case Channel::depth: return depth_needs(offer);
        case Channel::depth_mm: return first_of(offer, {Product::depth});
        case Channel::depth_error: return first_of(offer, {Product::depth_error});
        case Channel::confidence: return first_of(offer, {Product::confidence});
        case Channel::points: return points_needs(offer);
        case Channel::scan: return first_of(offer, {Product::scan});
        case Channel::transforms: return any_frame(offer);
        case Channel::imu:
        case Channel::magnetic_field:
        case Channel::imu_temperature:
        case Channel::camera_temperature:
        case Channel::left_temperature:
        case Channel::right_temperature:
        case Channel::pressure:
        case Channel::humidity: return offer.sensors ? std::optional(Wanted{.sensors = true}) : std::nullopt;
        case Channel::status: break;
    }
    return Wanted{.status = true};
}

}  // namespace disparityd::foxglove
