// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::test {

/// What the device can do at best, measured: the floor that times are put beside.
struct MachineFloor {
    double bytes_per_second = 0;  ///< read plus written, of large copies within the device
    // Minima of two 16-bit numbers each, taken in the ways of tests/cuda/minima.h.
    double minima_as_integers_per_second = 0;
    double minima_as_f16_per_second = 0;
    double minima_of_sum_per_second = 0;

    double max_minima_per_second() const {
        return minima_as_integers_per_second > minima_as_f16_per_second ? minima_as_integers_per_second
                                                                        : minima_as_f16_per_second;
    }
};
/// Throws std::runtime_error when the device refuses.
MachineFloor measure_floor();

}  // namespace disparityd::test
