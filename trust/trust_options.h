// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::trust {

struct TrustOptions {
    int dark_level = 20;   ///< dark: nine tenths of both pictures are darker than this grey level, 1 .. 255
    double rows_px = 0.4;  ///< misaligned: the median row error of a third of the picture is at least this, 0.1 .. 2.5
};

}  // namespace disparityd::trust
