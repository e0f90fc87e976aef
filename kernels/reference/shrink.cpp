// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "kernels/near_plane.h"
#include "kernels/reference/steps.h"

namespace disparityd::reference {

void shrink(Plane<const std::uint8_t> image, Plane<std::uint8_t> out, Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < out.width; ++x) {
            int sum = 0;
            for (int i = 0; i < near_block * near_block; ++i) {
                const int column = std::min(near_block * x + i % near_block, image.width - 1);
                const int row = std::min(near_block * y + i / near_block, image.height - 1);
                sum += image.at(column, row);
            }
            out.at(x, y) = static_cast<std::uint8_t>((sum + 8) >> 4);
        }
    }
}

}  // namespace disparityd::reference
