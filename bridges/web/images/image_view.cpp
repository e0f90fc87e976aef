// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/images/image_view.h"

#include <algorithm>
#include <iterator>

namespace disparityd::web {
namespace {

bool is_image(const proto::ProductFacts& product) {
    return product.view != v1::NO_VIEW && product.colour_of == v1::PRODUCT_NONE;
}

/// Returns the product that is the same in colour, where there is one.
std::optional<disparity::Product> in_colour(Image image) {
    const auto found = std::find_if(proto::products.begin(), proto::products.end(), [image](const auto& product) {
        return product.colour_of == static_cast<v1::Product>(image);
    });
    return found != proto::products.end() ? std::optional(static_cast<disparity::Product>(found->number))
                                          : std::nullopt;
}

}  // namespace

const proto::ProductFacts& facts_of(Image image) {
    return proto::product_facts(static_cast<v1::Product>(image));
}

std::optional<Image> image_of(std::string_view name) {
    const auto found = std::find_if(proto::products.begin(), proto::products.end(),
                                    [name](const auto& product) { return product.name == name && is_image(product); });
    return found != proto::products.end() ? std::optional(static_cast<Image>(found->number)) : std::nullopt;
}

std::string image_names() {
    std::string names;
    for (const proto::ProductFacts& product : proto::products) {
        if (is_image(product)) {
            names += (names.empty() ? "" : ", ") + std::string(product.name);
        }
    }
    return names;
}

int shared_width(int most) {
    const auto above = std::upper_bound(shared_widths.begin(), shared_widths.end(), most);
    return above == shared_widths.begin() ? shared_widths.front() : *std::prev(above);
}

disparity::Product product_of(Image image) {
    return image == Image::depth ? Image::disparity : image;
}

std::set<disparity::Product> products_of(Image image) {
    std::set<disparity::Product> products{product_of(image)};
    if (const auto colour = in_colour(image)) {
        products.insert(*colour);
    }
    return products;
}

const disparity::PlaneData* shown_plane(const disparity::Frame& frame, Image image) {
    const auto colour = in_colour(image);
    const disparity::PlaneData* const coloured = colour ? frame.plane(*colour) : nullptr;
    const disparity::PlaneData* const shown = coloured != nullptr ? coloured : frame.plane(product_of(image));
    return shown != nullptr && shown->width > 0 && shown->height > 0 ? shown : nullptr;
}

}  // namespace disparityd::web
