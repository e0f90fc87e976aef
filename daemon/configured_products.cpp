// SPDX-License-Identifier: Apache-2.0
#include "daemon/configured_products.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <variant>

#include "daemon/config/config_keys.h"
#include "proto/products.h"

namespace disparityd::daemon {
namespace {

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

}  // namespace disparityd::daemon
