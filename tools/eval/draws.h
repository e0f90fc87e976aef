// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>

namespace disparityd::eval {

/// Random numbers that are the same everywhere for the same seed, which those of the standard library's distributions
/// are not. One thread uses it.
class Draws {
public:
    explicit Draws(std::uint32_t seed) : random_(seed) {}

    /// A number from `least` to below `most`.
    double between(double least, double most) {
        return least + (most - least) * (static_cast<double>(random_()) / 4294967296.0);
    }

    /// A whole number from `least` to `most`.
    int whole(int least, int most) { return static_cast<int>(between(least, most + 1.0)); }

    /// Nearly Gaussian, mean 0, sigma 1, within 4.9 sigma: the sum of eight halves of 16 bits.
    double gaussian() {
        std::int64_t sum = -8 * 65535 / 2;
        for (int i = 0; i < 4; ++i) {
            const auto bits = static_cast<std::uint32_t>(random_());
            sum += (bits & 0xFFFFU) + (bits >> 16);
        }
        constexpr double sigma = 53509.94;  // of that sum: 65536 times the root of 8 / 12
        return static_cast<double>(sum) / sigma;
    }

private:
    std::mt19937 random_;
};

}  // namespace disparityd::eval
