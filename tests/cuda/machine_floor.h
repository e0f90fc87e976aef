// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::test {

/// What the device can do at best, measured: the floor that times are put beside.
struct MachineFloor {
    double bytes_per_second = 0;          ///< read plus written, of large copies within the device
    double packed_minima_per_second = 0;  ///< minima of two 16-bit numbers each
};
/// Throws std::runtime_error when the device refuses.
MachineFloor measure_floor();

}  // namespace disparityd::test
