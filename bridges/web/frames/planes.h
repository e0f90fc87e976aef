// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clients/cpp/disparity_client.hpp"

namespace disparityd::web {

/// Whether an image has the bytes for each pixel that its product says, and as many as its size asks for. No daemon of
/// ours sends another one, and what reads planes by their product would read beyond it. False for the scan, which is a
/// record.
bool is_whole_image(const disparity::PlaneData& plane);

/// Returns the image of a product when the frame carries it whole and it is not empty, else nullptr.
const disparity::PlaneData* whole_plane(const disparity::Frame& frame, disparity::Product product);

/// Removes all images that are not whole.
void leave_out_broken_planes(disparity::Frame& frame);

}  // namespace disparityd::web
