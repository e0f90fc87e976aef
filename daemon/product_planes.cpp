// SPDX-License-Identifier: Apache-2.0
#include "daemon/product_planes.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <variant>

#include "daemon/config/config_keys.h"
#include "proto/products.h"

namespace disparityd::daemon {
namespace {

template <auto member>
Plane<const std::uint8_t> bytes_of(const FrameView& view, const pipeline::RawEyes& /*raw*/) {
    const auto& plane = view.*member;
    constexpr int size = sizeof(*plane.data);
    return {reinterpret_cast<const std::uint8_t*>(plane.data), plane.width * size, plane.height, plane.stride * size};
}

template <Plane<std::uint8_t> pipeline::RawEyes::*member>
Plane<const std::uint8_t> raw_bytes(const FrameView& /*view*/, const pipeline::RawEyes& raw) {
    return raw.*member;
}

/// A record is made by an added stage.
Plane<const std::uint8_t> no_plane(const FrameView& /*view*/, const pipeline::RawEyes& /*raw*/) {
    return {};
}

/// In the order of proto::products.
constexpr std::array planes{
    &bytes_of<&FrameView::disparity>,     &bytes_of<&FrameView::confidence>,    &bytes_of<&FrameView::depth>,
    &bytes_of<&FrameView::left>,          &bytes_of<&FrameView::left_colour>,   &no_plane,
    &bytes_of<&FrameView::depth_error>,   &bytes_of<&FrameView::right>,         &bytes_of<&FrameView::right_colour>,
    &raw_bytes<&pipeline::RawEyes::left>, &raw_bytes<&pipeline::RawEyes::right>};
static_assert(planes.size() == proto::products.size(), "a product has no plane");

bool is_on(const Config& config, std::string_view key_name) {
    if (key_name.empty()) {
        return true;
    }
    const auto& keys = config_keys();
    const auto key =
        std::find_if(keys.begin(), keys.end(), [key_name](const ConfigKey& one) { return full_name(one) == key_name; });
    if (key == keys.end()) {
        throw std::logic_error("the table of products names a key that there is not: " + std::string(key_name));
    }
    return std::get<bool>(key->get(config));
}

}  // namespace

std::vector<v1::Product> configured_products(const Config& config) {
    std::vector<v1::Product> made;
    for (const proto::ProductFacts& product : proto::products) {
        const bool wanted =
            product.colour_of == v1::PRODUCT_NONE || is_on(config, proto::product_facts(product.colour_of).key);
        if (wanted && is_on(config, product.key)) {
            made.push_back(product.number);
        }
    }
    return made;
}

Plane<const std::uint8_t> product_plane(const FrameView& view, const pipeline::RawEyes& raw, v1::Product product) {
    return planes.at(static_cast<std::size_t>(product) - 1)(view, raw);
}

}  // namespace disparityd::daemon
