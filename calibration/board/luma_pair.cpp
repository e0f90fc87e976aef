// SPDX-License-Identifier: Apache-2.0
#include "calibration/board/luma_pair.h"

#include "kernels/reference/steps.h"

namespace disparityd::calibration {

LumaPair::LumaPair(const RawImage& raw)
    : width_(raw.eye_width),
      height_(raw.height),
      left_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)),
      right_(left_.size()) {
    const Rectifier as_it_is;
    reference::rectify(raw, Eye::left, as_it_is, {left_.data(), width_, height_, width_}, {0, height_});
    reference::rectify(raw, Eye::right, as_it_is, {right_.data(), width_, height_, width_}, {0, height_});
}

}  // namespace disparityd::calibration
