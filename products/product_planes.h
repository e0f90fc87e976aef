// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/image.h"
#include "kernels/matcher.h"
#include "pipeline/raw_eyes.h"
#include "proto/disparity.pb.h"

namespace disparityd::products {

/// The plane of a product as bytes: width and stride are counted in bytes. A view of what `view` and `raw` show. An
/// empty plane where the frame does not have it, and for a record. Throws std::out_of_range for a number that is no
/// product's.
Plane<const std::uint8_t> product_plane(const FrameView& view, const pipeline::RawEyes& raw, v1::Product product);

}  // namespace disparityd::products
