// SPDX-License-Identifier: Apache-2.0
#include "products/product_planes.h"

#include <array>
#include <stdexcept>

#include "proto/products.h"

namespace disparityd::products {
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

}  // namespace

Plane<const std::uint8_t> product_plane(const FrameView& view, const pipeline::RawEyes& raw, v1::Product product) {
    return planes.at(static_cast<std::size_t>(product) - 1)(view, raw);
}

}  // namespace disparityd::products
