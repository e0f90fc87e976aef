// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/config/config.h"
#include "proto/disparity.pb.h"

/// Connects the table of proto/products.h with the configuration.
namespace disparityd::daemon {

/// The products that a configuration makes, in the order of their numbers.
std::vector<v1::Product> configured_products(const Config& config);

}  // namespace disparityd::daemon
